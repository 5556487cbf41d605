#import "lib/enables_nonsense.wgsl"
@fragment fn main() -> @location(0) f32 { return two; }
