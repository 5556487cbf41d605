// Imported by cases.
fn half(x: f32) -> f32 {
    return x * ;
}
