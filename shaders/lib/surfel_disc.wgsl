// A surfel as a disc at right angles to its normal, on a quad; `side` runs from -1 to 1 on both axes of the quad.
#import "lib/camera.wgsl"
#import "lib/surfel.wgsl"

/// Draw what shows its other side: where light leaves again.
override back: bool = false;

/// 1 where the eye is outside what the surfels enclose, -1 inside.
var<storage, read> eye: array<f32>;

/// Weight of a place on a disc, which is a radius of 1 wide: a Gaussian cut off at the rim.
fn surfel_weight(side: vec2f) -> f32 {
    return exp(-3.0 * dot(side, side));
}

/// Corner 0 to 3 of a triangle strip, from -1 to 1.
fn quad_side(corner: u32) -> vec2f {
    return vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
}

/// The corner of a surfel's quad in world space.
fn surfel_corner(surfel: Surfel, side: vec2f) -> vec3f {
    let n = surfel.normal;
    // Whichever axis is farther from the normal.
    let other = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(n.x) > 0.7);
    let u = normalize(cross(other, n));
    return surfel.position + surfel.radius * (side.x * u + side.y * cross(n, u));
}

/// Unit direction in which a point is seen.
fn seen_along(p: vec3f) -> vec3f {
    if camera.orthographic != 0u {
        return -camera.world_from_view[2].xyz;
    }
    return normalize(p - camera.position);
}

/// Whether a surfel shows the side on which the eye is, or the other one if that is asked for.
fn surfel_faces(surfel: Surfel) -> bool {
    let towards = eye[0] * dot(surfel.normal, seen_along(surfel.position));
    return select(towards, -towards, back) < 0.0;
}
