struct Out { @location(0) color: vec4<f32>, z: f32 }
@fragment fn main() -> Out { return Out(vec4<f32>(1.0), 0.0); }
