// Imported by cases.
fn one() -> f32 { return 1.0; }
/* This comment /* nests */ and is never closed.
fn two() -> f32 { return 2.0; }
