// The shadow of meshes under water: their heights along the sun's direction below a level surface, on the virtual
// screen. The paper's caustics pass through what they light.
#import "lib/light_screen.wgsl"

/// Where a point's straight shadow line meets the screen, from 0 to 1, and its height as reversed depth.
fn shadow_place(p: vec3f) -> vec3f {
    let corners = screen_corners();
    let bent = bent_sun();
    let at = p.xz + bent.xz / bent.y * (light_screen.top_m - p.y);
    let uv = (at - corners.xy) / (corners.zw - corners.xy);
    // Room for what stands out of the water.
    let height = (p.y - light_screen.bottom_m) / (light_screen.top_m - light_screen.bottom_m);
    return vec3f(uv, clamp(0.05 + 0.45 * height, 0.0, 1.0));
}
