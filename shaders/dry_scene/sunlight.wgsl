// How much of the sun's light reaches a point: through the water above it, and past the meshes.
#import "lib/light.wgsl"
#import "lib/sun_view.wgsl"

struct Sunlight {
    middle: vec2f,
    shadow_m: f32,
    floor_m: f32,
    shadow: f32,
    absorption: vec3f,
    particles_radius: f32,
    cast_middle: vec3f,
    cast_radius_m: f32,
    cast_px: u32,
}

override casts: bool = false;

var<uniform> sunlight: Sunlight;
var<uniform> sun: Light;
// Metres of liquid along each ray of the sun, and that times their height and their height squared.
var thickness: texture_2d<f32>;
var linear_clamp: sampler;
var sun_depth: texture_depth_2d;
var depth_compare: sampler_comparison;

/// Share of the sun's light that comes through the water above a point.
fn through_water(p: vec3f) -> vec3f {
    let fall = (p.y - sunlight.floor_m) / max(-sun.direction.y, 1.0e-3);
    let on_floor = p.xz + sun.direction.xz * fall;
    let uv = (on_floor - sunlight.middle) / sunlight.shadow_m * 0.5 + 0.5;
    let moments = textureSampleLevel(thickness, linear_clamp, uv, 0.0).xyz;
    if moments.x <= 0.0 || any(uv <= vec2f(0.0)) || any(uv >= vec2f(1.0)) {
        return vec3f(1.0);
    }
    // As if the liquid filled the ray evenly, as high and as far apart as its mean and variance say.
    let mean = moments.y / moments.x;
    let half_m = sqrt(3.0 * max(moments.z / moments.x - mean * mean, 0.0)) + sunlight.particles_radius / sunlight.shadow_m;
    let height = (p.y - sunlight.floor_m) / sunlight.shadow_m;
    let depth_m = moments.x * clamp((mean + half_m - height) / (2.0 * half_m), 0.0, 1.0);
    let covered = 1.0 - exp(-depth_m / (2.0 * sunlight.particles_radius));
    return (1.0 - sunlight.shadow * covered) * exp(-sunlight.absorption * depth_m);
}

/// Share of the sun that no mesh hides, softened over a few texels.
fn past_meshes(p: vec3f, normal: vec3f) -> f32 {
    if !casts {
        return 1.0;
    }
    let texel_m = 2.0 * sunlight.cast_radius_m / f32(sunlight.cast_px);
    // Off the surface by more the more it slants, so that no surface shades itself.
    let slant = 1.0 - abs(dot(normal, sun.direction));
    let at = p + normal * texel_m * (1.0 + 2.0 * slant) - sun.direction * texel_m;
    let view = sun_view(at, sunlight.cast_middle, sunlight.cast_radius_m, sun.direction);
    let uv = view.xy * vec2f(0.5, -0.5) + 0.5;
    if any(uv <= vec2f(0.0)) || any(uv >= vec2f(1.0)) || view.z <= 0.0 || view.z >= 1.0 {
        return 1.0;
    }
    var lit = 0.0;
    for (var k = 0; k < 9; k++) {
        let offset = vec2f(f32(k % 3 - 1), f32(k / 3 - 1)) * 1.2 / f32(sunlight.cast_px);
        lit += textureSampleCompareLevel(sun_depth, depth_compare, uv + offset, view.z);
    }
    return lit / 9.0;
}

/// The sun's irradiance on a surface at a point.
fn from_sun(p: vec3f, normal: vec3f) -> vec3f {
    let facing = dot(normal, -sun.direction);
    if facing <= 0.0 {
        return vec3f(0.0);
    }
    return irradiance(sun) * facing * through_water(p) * past_meshes(p, normal);
}
