// The error is two imports away.
#import "lib/imports_broken.wgsl"

@fragment fn main() -> @location(0) f32 { return quarter(1.0); }
