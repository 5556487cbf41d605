// The ball that floats on the pool: where it is at any time.

/// Its centre, the water's still surface at y = 0, the pool's middle at the origin: a figure of eight.
fn ball_at(time: f32, extent: vec2f, radius: f32) -> vec3f {
    let reach = max(0.5 * extent - 1.9 * radius, vec2f(0.0));
    let phase = 0.5 * time;
    return vec3f(reach.x * sin(phase), 0.15 * radius, 0.85 * reach.y * sin(2.0 * phase));
}

/// How deep it presses the surface at a place, in metres: smooth, and zero outside.
fn pressed_by_ball(at: vec2f, centre: vec3f, radius: f32) -> f32 {
    let away = at - centre.xz;
    let rest = max(1.0 - dot(away, away) / max(radius * radius, 1.0e-12), 0.0);
    return radius * rest * rest;
}
