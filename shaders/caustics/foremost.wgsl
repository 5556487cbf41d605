// Depth of the surfels that the light meets first, moved away from it by epsilon, so that drops above a pool are not
// mixed with it. The paper has one layer and needs no such pass.
#import "lib/light_disc.wgsl"

struct Params {
    epsilon: f32,
}

var<uniform> params: Params;
var<storage, read> surfels: Surfels;

@vertex
fn disc(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Disc {
    return disc_on_screen(surfels.items[instance], corner, params.epsilon);
}

@fragment
fn cut(in: Disc) {
    if dot(in.side, in.side) > 1.0 {
        discard;
    }
}
