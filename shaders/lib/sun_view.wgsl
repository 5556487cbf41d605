// The sun's view of a ball, for shadow maps.

/// x and y from -1 to 1 across the ball, z from 0 (far) to 1 (near the sun).
fn sun_view(p: vec3f, center: vec3f, radius: f32, direction: vec3f) -> vec3f {
    let up = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(direction.y) > 0.99);
    let right = normalize(cross(direction, up));
    let q = (p - center) / radius;
    return vec3f(dot(q, right), dot(q, cross(right, direction)), 0.5 - 0.5 * dot(q, direction));
}
