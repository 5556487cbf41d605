// Imported by cases.

#import "broken.wgsl"

fn quarter(x: f32) -> f32 { return half(half(x)); }
