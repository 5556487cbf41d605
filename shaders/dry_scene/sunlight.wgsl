// How much of the sun's light reaches a point past the meshes. What the water leaves of it is said by who asks, from
// `through_thickness.wgsl` or `through_caustics.wgsl`.
#import "lib/sun.wgsl"
#import "lib/sun_view.wgsl"

struct Sunlight {
    cast_middle: vec3f,
    cast_radius_m: f32,
    cast_px: u32,
}

override casts: bool = false;

var<uniform> sunlight: Sunlight;
var sun_depth: texture_depth_2d;
var depth_compare: sampler_comparison;

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

/// The sun's irradiance on a surface at a point, of which the water lets the share `through` pass.
fn from_sun(p: vec3f, normal: vec3f, through: vec3f) -> vec3f {
    let facing = dot(normal, -sun.direction);
    if facing <= 0.0 {
        return vec3f(0.0);
    }
    return irradiance(sun) * facing * through * past_meshes(p, normal);
}
