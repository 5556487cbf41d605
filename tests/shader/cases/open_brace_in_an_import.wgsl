#import "lib/open_brace.wgsl"
@fragment fn main() -> @location(0) f32 { return one(); }
