struct Inner { a: f32 }
struct Between { @builtin(position) at: vec4<f32>, @location(0) inner: Inner, @location(1) uv: vec2<f32> }
@vertex fn main() -> Between { return Between(vec4<f32>(0.0), Inner(1.0), vec2<f32>(0.0)); }
