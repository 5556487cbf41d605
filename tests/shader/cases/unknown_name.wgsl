var<uniform> smoothing_radius: f32;
@fragment fn main() -> @location(0) f32 { return smoothing_raduis * 2.0; }
