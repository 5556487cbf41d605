fn even(n: u32) -> bool { return n == 0u || odd(n - 1u); }
fn odd(n: u32) -> bool { return n != 0u && even(n - 1u); }
@fragment fn main() -> @location(0) f32 { return f32(even(4u)); }
