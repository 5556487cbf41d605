var picture: texture_2d<f32>;
var linear_clamp: sampler;
var<storage, read_write> out: array<f32>;
@compute @workgroup_size(64) fn main() { out[0] = textureSample(picture, linear_clamp, vec2<f32>(0.5)).x; }
