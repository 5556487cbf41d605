struct Out { @location(1) color: vec4<f32>, @location(1) normal: vec4<f32> }
@fragment fn main() -> Out { return Out(vec4<f32>(1.0), vec4<f32>(0.0)); }
