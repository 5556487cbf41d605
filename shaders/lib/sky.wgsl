// A clear sky with a sun by day: gradients fitted by eye, no model of the atmosphere.

const ZENITH = vec3f(0.10, 0.24, 0.58);
const HORIZON = vec3f(0.62, 0.74, 0.88);
const GROUND = vec3f(0.30, 0.29, 0.28);

/// Radiance of the sky without the sun's disc; `sun` is the unit direction to the sun.
fn sky_radiance(direction: vec3f, sun: vec3f, brightness: f32) -> vec3f {
    let up = direction.y;
    let haze = pow(1.0 - clamp(up, 0.0, 1.0), 3.5);
    var color = mix(ZENITH, HORIZON, haze);
    let near_sun = max(dot(direction, sun), 0.0);
    color += vec3f(1.0, 0.86, 0.66) * (0.35 * pow(near_sun, 32.0) + 0.25 * haze * pow(near_sun, 4.0));
    // The ground below runs into the horizon's haze.
    color = mix(color, GROUND * (0.75 + 0.5 * max(sun.y, 0.0)), smoothstep(0.01, -0.12, up));
    return brightness * color;
}

/// Radiance of the sun's disc with a soft rim, so that it brings `irradiance` to a surface that faces it.
fn sun_radiance(direction: vec3f, sun: vec3f, irradiance: vec3f, radius: f32) -> vec3f {
    let chord = length(direction - sun);
    let disc = 1.0 - smoothstep(0.7 * radius, 1.3 * radius, chord);
    return irradiance * disc / (3.14159265 * radius * radius);
}
