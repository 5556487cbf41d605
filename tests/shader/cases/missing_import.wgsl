// Two at once.
#import "lib/camra.wgsl"
#import "nowhere.wgsl"
@fragment fn main() {}
