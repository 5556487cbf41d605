@fragment fn main(@location(0) uv: vec2<f32>) -> @location(0) f32 {
    var distance_m = length(uv);
    distance_n *= 2.0;
    return distance_m;
}
