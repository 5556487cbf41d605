const halves = 1 / 0;
@fragment fn main() -> @location(0) f32 { return f32(halves); }
