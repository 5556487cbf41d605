// Places in an equirectangular picture: the middle looks along -z, the top is +y.

fn equirect_uv(direction: vec3f) -> vec2f {
    let along = atan2(direction.x, -direction.z) / 6.28318531 + 0.5;
    let down = acos(clamp(direction.y, -1.0, 1.0)) / 3.14159265;
    return vec2f(along, down);
}
