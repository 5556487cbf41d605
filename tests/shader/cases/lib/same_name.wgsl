// Imported by cases.
const radius = 0.5;
fn area(r: f32) -> f32 { return 3.1 * r * r; }
