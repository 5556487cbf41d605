// Imported by cases.
fn one() -> f32 {
    if true { return 1.0;
}
