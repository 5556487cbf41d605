#import "packed.wgsl"
@fragment fn main() {}
