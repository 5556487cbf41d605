var<uniform> weights: array<vec4<f32>>;
@fragment fn main() -> @location(0) vec4<f32> { return weights[0]; }
