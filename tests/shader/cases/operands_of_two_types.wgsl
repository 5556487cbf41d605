var<uniform> count: u32;
@fragment fn main() -> @location(0) f32 {
    let share = 1.0 / count;
    return share;
}
