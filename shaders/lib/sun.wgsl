// The light that a graph calls `sun`.
#import "lib/light.wgsl"

var<uniform> sun: Light;
