var<uniform> a: vec3<f32>;
var<uniform> b: vec2<f32>;
@fragment fn main() -> @location(0) f32 {
    return length(a + b);
}
