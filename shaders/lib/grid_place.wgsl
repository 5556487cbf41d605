// A place where a surfel may be: a grid point, and which of its three edges (0 to 2) or faces (3 to 5). Ten bits for
// each coordinate.

fn pack_place(at: vec3i, kind: u32) -> vec2u {
    return vec2u(u32(at.x) | (u32(at.y) << 10u) | (u32(at.z) << 20u), kind);
}

fn unpack_place(place: vec2u) -> vec3i {
    return vec3i(vec3u(place.x, place.x >> 10u, place.x >> 20u) & vec3u(1023u));
}
