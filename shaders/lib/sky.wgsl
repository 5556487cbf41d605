// A clear sky with a sun by day: gradients fitted by eye, no model of the atmosphere.

const ZENITH = vec3f(0.07, 0.21, 0.58);
const HORIZON = vec3f(0.74, 0.84, 0.94);
/// Albedo of the ground below the horizon, which lies in sun and sky light like a floor.
const GROUND = vec3f(0.52, 0.46, 0.39);
/// Irradiance of the sky on the ground at brightness 1.
const SKY_IRRADIANCE = vec3f(1.05, 1.45, 2.05);

/// Radiance of sky and ground without the sun's disc; `sun` is the unit direction to the sun.
fn sky_radiance(direction: vec3f, sun: vec3f, irradiance: vec3f, brightness: f32) -> vec3f {
    let up = direction.y;
    let haze = pow(1.0 - clamp(abs(up), 0.0, 1.0), 4.0);
    var above = mix(ZENITH, HORIZON, haze);
    let near_sun = max(dot(direction, sun), 0.0);
    above += vec3f(1.0, 0.86, 0.66) * (0.3 * pow(near_sun, 48.0) + 0.2 * haze * pow(near_sun, 4.0));
    let lit = brightness * SKY_IRRADIANCE + irradiance * max(sun.y, 0.0);
    // Far ground is seen through as much haze as the sky beside it.
    let below = mix(GROUND * lit / 3.14159265, brightness * HORIZON, pow(1.0 - clamp(-up, 0.0, 1.0), 16.0));
    return select(brightness * above, below, up < 0.0);
}

/// Radiance of the sun's disc with a soft rim, so that it brings `irradiance` to a surface that faces it.
fn sun_radiance(direction: vec3f, sun: vec3f, irradiance: vec3f, radius: f32) -> vec3f {
    let chord = length(direction - sun);
    let disc = 1.0 - smoothstep(0.7 * radius, 1.3 * radius, chord);
    return irradiance * disc / (3.14159265 * radius * radius);
}
