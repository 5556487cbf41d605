// A directional light as the scene gives it.

struct Light {
    // Unit vector in world space, from the light into the scene.
    direction: vec3f,
    // Linear colour; times the intensity it is the irradiance on a surface that faces the light.
    color: vec3f,
    intensity: f32,
}

fn irradiance(light: Light) -> vec3f {
    return light.color * light.intensity;
}
