var shadow: texture_depth_2d;
var depth_compare: sampler_comparison;
@fragment fn main() -> @location(0) f32 { return textureSample(shadow, depth_compare, vec2<f32>(0.5)); }
