// Sliced object images (Iwasaki et al. 2006, sections 5.2 and 5.3): each shows the meshes between two sample planes. The
// paper leaves open from where; here along the viewer's refracted direction through a level surface, so that upright
// sides show too and a ray along that direction meets them exactly.
#import "lib/light_screen.wgsl"
#import "lib/optics.wgsl"

/// The direction along which slices are seen from an eye.
fn slice_view(eye: vec3f) -> vec3f {
    let middle = 0.5 * (light_screen.region_min + light_screen.region_max);
    let towards = normalize(vec3f(middle.x, mix(light_screen.bottom_m, light_screen.top_m, 0.5), middle.y) - eye);
    // From above the water, or from so low that it looks along the slices.
    let bent = bend_in(normalize(vec3f(towards.x, min(towards.y, -0.05), towards.z)), vec3f(0.0, 1.0, 0.0), light_screen.ior);
    return bent.direction;
}

/// Height of plane k of so many.
fn plane_height(k: u32, planes: u32) -> f32 {
    return mix(light_screen.top_m, light_screen.bottom_m, f32(k) / f32(planes - 1u));
}

/// The place of a point on a plane along a direction, from 0 to 1 over the region, with a quarter more around.
fn slice_uv(p: vec3f, direction: vec3f, height: f32) -> vec2f {
    let at = p.xz + direction.xz / direction.y * (height - p.y);
    let inner = (at - light_screen.region_min) / (light_screen.region_max - light_screen.region_min);
    return (inner - 0.5) / 1.25 + 0.5;
}
