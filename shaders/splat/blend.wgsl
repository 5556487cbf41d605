// Second pass: normal and eye z of the surfels within epsilon of the foremost, with Gaussian weights (Iwasaki et al.
// 2006, section 5.3). The paper blends shaded colours; blending what is shaded keeps highlights sharp.
#import "lib/surfel_disc.wgsl"

struct Disc {
    @builtin(position) clip: vec4f,
    @location(0) side: vec2f,
    @location(1) z: f32,
    @location(2) @interpolate(flat) normal: vec3f,
}

struct Sums {
    @location(0) normal: vec4f,
    @location(1) z: f32,
}

var<storage, read> surfels: Surfels;

@vertex
fn disc(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Disc {
    let surfel = surfels.items[instance];
    let side = quad_side(corner);
    let p = surfel_corner(surfel, side);
    var clip = camera.clip_from_world * vec4f(p, 1.0);
    if !surfel_faces(surfel) {
        clip = vec4f(2.0, 2.0, 0.5, 1.0);
    }
    return Disc(clip, side, eye_from_world_point(p).z, (camera.view_from_world * vec4f(surfel.normal, 0.0)).xyz);
}

@fragment
fn weigh(in: Disc) -> Sums {
    if dot(in.side, in.side) > 1.0 {
        discard;
    }
    let weight = surfel_weight(in.side);
    return Sums(weight * vec4f(in.normal, 1.0), weight * in.z);
}
