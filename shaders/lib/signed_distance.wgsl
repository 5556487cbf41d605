// Looking up what graphs/parts/signed_distance.ron made.

/// Signed distance in metres at a point in world space, linear between the middles of cells. `low` and `cell` are the part's.
fn signed_distance(distances: texture_3d<f32>, low: vec3f, cell: f32, p: vec3f) -> f32 {
    let last = vec3i(textureDimensions(distances)) - 1;
    let at = (p - low) / cell - 0.5;
    let base = floor(at);
    let part = at - base;
    var sum = 0.0;
    for (var corner = 0u; corner < 8u; corner++) {
        let step = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let weight = select(1.0 - part, part, step == vec3u(1u));
        let texel = clamp(vec3i(base) + vec3i(step), vec3i(0), last);
        sum += weight.x * weight.y * weight.z * textureLoad(distances, texel, 0).r;
    }
    return sum;
}
