// A clear sky from day to night, as the sun's height says: gradients fitted by eye, no model of the atmosphere.

const ZENITH = vec3f(0.07, 0.21, 0.58);
const HORIZON = vec3f(0.74, 0.84, 0.94);
/// Of the horizon below which the sun goes down.
const DUSK = vec3f(1.0, 0.42, 0.16);
/// The sine of the sun's height from which on it is full day, and that at which it is night.
const DAY = 0.3;
const NIGHT = -0.25;
/// Light of the night sky, against the day's.
const STARLIGHT = 0.004;
/// Albedo of the ground below the horizon, which lies in sun and sky light like a floor.
const GROUND = vec3f(0.52, 0.46, 0.39);
/// Irradiance of the sky on the ground at brightness 1.
const SKY_IRRADIANCE = vec3f(1.05, 1.45, 2.05);

/// Radiance of sky and ground without the sun's disc; `sun` is the unit direction to the sun.
fn sky_radiance(direction: vec3f, sun: vec3f, irradiance: vec3f, brightness: f32) -> vec3f {
    let up = direction.y;
    let haze = pow(1.0 - clamp(abs(up), 0.0, 1.0), 4.0);
    let near_sun = max(dot(direction, sun), 0.0);
    let day = daylight(sun.y);
    let low = dusk(sun.y);
    // Towards the sun the whole horizon is warm, away from it only a band.
    let warm = low * mix(0.25, 1.0, pow(0.5 + 0.5 * dot(direction, sun), 2.0));
    let horizon = mix(HORIZON, DUSK, warm);
    var above = day * mix(ZENITH, horizon, haze);
    above += day * mix(vec3f(1.0, 0.86, 0.66), DUSK, low) * (0.3 * pow(near_sun, 48.0) + 0.2 * haze * pow(near_sun, 4.0));
    let lit = brightness * day * SKY_IRRADIANCE + irradiance * max(sun.y, 0.0);
    // Far ground is seen through as much haze as the sky beside it.
    let below = mix(GROUND * lit / 3.14159265, brightness * day * horizon, pow(1.0 - clamp(-up, 0.0, 1.0), 16.0));
    return select(brightness * above, below, up < 0.0);
}

/// Light of the sky against that of full day, for the sine of the sun's height.
fn daylight(height: f32) -> f32 {
    let share = smoothstep(NIGHT, DAY, height);
    return mix(STARLIGHT, 1.0, share * share);
}

/// How much of dusk or dawn there is: most where the sun touches the horizon.
fn dusk(height: f32) -> f32 {
    return (1.0 - smoothstep(0.0, DAY, height)) * smoothstep(NIGHT, 0.0, height);
}

/// Radiance of the sun's disc with a soft rim, so that it brings `irradiance` to a surface that faces it.
fn sun_radiance(direction: vec3f, sun: vec3f, irradiance: vec3f, radius: f32) -> vec3f {
    let chord = length(direction - sun);
    let disc = 1.0 - smoothstep(0.7 * radius, 1.3 * radius, chord);
    return irradiance * disc / (3.14159265 * radius * radius);
}
