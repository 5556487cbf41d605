var<uniform> target: f32;
@fragment fn main() -> @location(0) f32 { return target; }
