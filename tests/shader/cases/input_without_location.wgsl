@fragment fn main(uv: vec2<f32>) -> @location(0) vec2<f32> { return uv; }
