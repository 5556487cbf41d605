@fragment fn main(@location(0) id: u32) -> @location(0) f32 { return f32(id); }
