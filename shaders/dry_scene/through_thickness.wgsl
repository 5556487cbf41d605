// How much of the sun's light comes through the water, which fades it.
#import "lib/linear_clamp.wgsl"
#import "lib/sun.wgsl"

struct Shade {
    middle: vec2f,
    shadow_m: f32,
    floor_m: f32,
    shadow: f32,
    absorption: vec3f,
    particles_radius: f32,
}

var<uniform> shade_of: Shade;
// Metres of liquid along each ray of the sun, and that times their height and their height squared.
var thickness: texture_2d<f32>;

/// Share of the sun's light that comes through the water above a point.
fn through_water(p: vec3f) -> vec3f {
    let fall = (p.y - shade_of.floor_m) / max(-sun.direction.y, 1.0e-3);
    let on_floor = p.xz + sun.direction.xz * fall;
    let uv = (on_floor - shade_of.middle) / shade_of.shadow_m * 0.5 + 0.5;
    let moments = textureSampleLevel(thickness, linear_clamp, uv, 0.0).xyz;
    if moments.x <= 0.0 || any(uv <= vec2f(0.0)) || any(uv >= vec2f(1.0)) {
        return vec3f(1.0);
    }
    // As if the liquid filled the ray evenly, as high and as far apart as its mean and variance say.
    let mean = moments.y / moments.x;
    let half_m = sqrt(3.0 * max(moments.z / moments.x - mean * mean, 0.0)) + shade_of.particles_radius / shade_of.shadow_m;
    let height = (p.y - shade_of.floor_m) / shade_of.shadow_m;
    let depth_m = moments.x * clamp((mean + half_m - height) / (2.0 * half_m), 0.0, 1.0);
    let covered = 1.0 - exp(-depth_m / (2.0 * shade_of.particles_radius));
    return (1.0 - shade_of.shadow * covered) * exp(-shade_of.absorption * depth_m);
}
