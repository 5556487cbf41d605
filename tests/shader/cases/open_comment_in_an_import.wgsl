#import "lib/open_comment.wgsl"
@fragment fn main() -> @location(0) f32 { return one() + two(); }
