fn sign_of(x: f32) -> i32 {
    return x;
}
@fragment fn main() -> @location(0) f32 { return f32(sign_of(1.0)); }
