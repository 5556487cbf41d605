// The next word stands here, the mistake does not.
#import "lib/no_semicolon.wgsl"

@fragment fn main() -> @location(0) f32 { return one; }
