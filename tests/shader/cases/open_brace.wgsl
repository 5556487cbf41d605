fn one() -> f32 { return 1.0; }
@fragment fn main() -> @location(0) f32 {
    if one() > 0.0 {
    return one();
}
