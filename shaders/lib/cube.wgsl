// Directions of a cube map's texels: faces +x, -x, +y, -y, +z, -z as the layers of a 2D array.

/// World direction of a face's point, uv from its top left corner; not of unit length.
fn cube_direction(face: u32, uv: vec2f) -> vec3f {
    let s = 2.0 * uv.x - 1.0;
    let t = 2.0 * uv.y - 1.0;
    switch face {
        case 0u: { return vec3f(1.0, -t, -s); }
        case 1u: { return vec3f(-1.0, -t, s); }
        case 2u: { return vec3f(s, 1.0, t); }
        case 3u: { return vec3f(s, -1.0, -t); }
        case 4u: { return vec3f(s, -t, 1.0); }
        default: { return vec3f(-s, -t, -1.0); }
    }
}
