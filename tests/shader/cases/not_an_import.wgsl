#include "lib/same_name.wgsl"
#define COUNT 4
#import lib/same_name.wgsl
let x = 1; #import "lib/same_name.wgsl"
#import "lib/same_name.wgsl" as names
@fragment fn main() {}
