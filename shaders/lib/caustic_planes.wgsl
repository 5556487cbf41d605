// Light under water between the sample planes (Iwasaki et al. 2006, section 5.1), for whatever lies there.
#import "lib/harmonics.wgsl"
#import "lib/light_screen.wgsl"
#import "lib/mesh_shadow.wgsl"
#import "lib/sample_planes.wgsl"
#import "lib/surface_light.wgsl"

struct Planes {
    planes: u32,
    absorption: vec3f,
}

var<uniform> plane_stack: Planes;
var surface: texture_2d<f32>;
var<storage, read> ambient: array<vec4f>;
var mesh_heights: texture_depth_2d;
var depth_compare: sampler_comparison;

/// The sun's light through a level square metre at a point; plain sun outside the planes' rectangle.
fn light_on_level(p: vec3f) -> vec3f {
    let light = between_planes(p);
    return select(irradiance(sun) * max(-sun.direction.y, 0.0), light.rgb, light.w > 0.0);
}

/// Metres of water that the sun's light has behind it at a point, by the surface that the light met first.
fn under_water_m(p: vec3f) -> f32 {
    let uv = screen_uv(p);
    if any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)) {
        return 0.0;
    }
    let water = textureLoad(surface, vec2i(uv * vec2f(textureDimensions(surface))), 0);
    return select(max(screen_path(p) - water.w, 0.0), 0.0, dot(water.xyz, water.xyz) == 0.0);
}

/// Share of the sun's light that meshes let through to a point.
fn past_meshes(p: vec3f) -> f32 {
    let place = shadow_place(p);
    let texel = 1.0 / vec2f(textureDimensions(mesh_heights));
    var open = 0.0;
    for (var k = 0; k < 9; k++) {
        let uv = place.xy + vec2f(vec2i(k % 3, k / 3) - 1) * texel;
        open += textureSampleCompareLevel(mesh_heights, depth_compare, uv, place.z + 0.004) / 9.0;
    }
    return select(1.0, open, all(abs(place.xy - 0.5) < vec2f(0.5)));
}

fn sky_light(normal: vec3f) -> vec3f {
    let basis = harmonics(normal);
    var sum = vec3f(0.0);
    for (var k = 0u; k < 9u; k++) {
        sum += ambient[k].rgb * basis[k];
    }
    return max(sum, vec3f(0.0));
}

/// Light on a surface at a point with a normal: equation 2's receiver, the sun's share turned from the planes to the
/// surface, and the ambient share L_a.
fn light_of_planes(p: vec3f, normal: vec3f) -> SurfaceLight {
    let water_m = under_water_m(p);
    let wet = water_m > 0.0;
    let towards = -select(sun.direction, bent_sun(), wet);
    let turned = max(dot(normal, towards), 0.0) / max(towards.y, 0.1);
    // Water lets most of the sky's light in; it comes from above then.
    let sky = select(sky_light(normal), 0.9 * mix(sky_light(normal), sky_light(vec3f(0.0, 1.0, 0.0)), 0.5), wet);
    let sky_left = exp(-plane_stack.absorption * max(-sun.direction.y, 0.0) * water_m);
    return SurfaceLight(sky * sky_left, sky_left, light_on_level(p) * past_meshes(p) * turned, towards);
}

/// What a matt surface of albedo 1 sends back of it.
fn lit(p: vec3f, normal: vec3f) -> vec3f {
    let light = light_of_planes(p, normal);
    return (light.sun + light.sky) / 3.14159265;
}
