fn scale(by: f32, v: vec3<f32>) -> vec3<f32> { return by * v; }
var<uniform> count: u32;
@fragment fn main() -> @location(0) vec3<f32> { return scale(count, vec3<f32>(1.0)); }
