@fragment fn main(@location(0) uv: vec2<f32>) -> @location(0) f32 {
    return length(uv * (1.0 + uv.x);
}
