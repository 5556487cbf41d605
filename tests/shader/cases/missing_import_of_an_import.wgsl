#import "lib/imports_missing.wgsl"
@fragment fn main() {}
