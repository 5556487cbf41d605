@fragment fn main(@location(0) uv: vec2<f32>) -> @location(0) f32 { return clmap(uv.x, 0.0, 1.0); }
