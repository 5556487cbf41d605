fn positive(x: f32) -> f32 {
    if x > 0.0 {
        return x;
    }
}
@fragment fn main() -> @location(0) f32 { return positive(1.0); }
