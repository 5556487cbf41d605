// First pass: depth of the surfels, moved away from the viewer by epsilon (Iwasaki et al. 2006, section 5.3).
#import "lib/surfel_disc.wgsl"

struct Params {
    epsilon: f32,
}

struct Disc {
    @builtin(position) clip: vec4f,
    @location(0) side: vec2f,
}

var<uniform> params: Params;
var<storage, read> surfels: Surfels;

@vertex
fn disc(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Disc {
    let surfel = surfels.items[instance];
    let side = quad_side(corner);
    let p = surfel_corner(surfel, side);
    var clip = camera.clip_from_world * vec4f(p + params.epsilon * seen_along(p), 1.0);
    // What faces away is not seen.
    if !surfel_faces(surfel) {
        clip = vec4f(2.0, 2.0, 0.5, 1.0);
    }
    return Disc(clip, side);
}

@fragment
fn cut(in: Disc) {
    if dot(in.side, in.side) > 1.0 {
        discard;
    }
}
