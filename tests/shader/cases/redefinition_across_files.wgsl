#import "lib/same_name.wgsl"

fn area(side: f32) -> f32 { return side * side; }
@fragment fn main() -> @location(0) f32 { return area(radius); }
