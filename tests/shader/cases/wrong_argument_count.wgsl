fn scale(by: f32, v: vec3<f32>) -> vec3<f32> { return by * v; }
@fragment fn main() -> @location(0) vec3<f32> { return scale(vec3<f32>(1.0)); }
