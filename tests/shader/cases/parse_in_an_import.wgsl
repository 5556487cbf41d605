#import "lib/broken.wgsl"

@fragment fn main() -> @location(0) f32 { return half(1.0); }
