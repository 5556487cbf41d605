// The virtual screen of the caustics (Iwasaki et al. 2006, section 5.2): a horizontal rectangle at the water's top,
// from which the light's parallel rays go down through the middles of its pixels, slanted or not.
#import "lib/light.wgsl"

struct LightScreen {
    // What is to be lit, in x and z, and its heights.
    region_min: vec2f,
    region_max: vec2f,
    top_m: f32,
    bottom_m: f32,
    // Pixels of the virtual screen.
    screen_px: vec2f,
    ior: f32,
}

var<uniform> light_screen: LightScreen;
var<uniform> sun: Light;

/// A light from the horizon or from below lights nothing here.
const LOWEST = -0.02;

fn sun_shines() -> bool {
    return sun.direction.y < LOWEST;
}

/// The sun's direction below a level surface.
fn bent_sun() -> vec3f {
    let side = sun.direction.xz / light_screen.ior;
    return vec3f(side.x, -sqrt(max(1.0 - dot(side, side), 0.0)), side.y);
}

/// Lowest and highest corner of the screen: the region, and where its light comes from. The middles of the outermost
/// pixels lie on its rim, so that beams between them cover it.
fn screen_corners() -> vec4f {
    // As it comes, which is further than bent by water.
    let away = sun.direction.xz / min(sun.direction.y, -0.1) * (light_screen.top_m - light_screen.bottom_m);
    let low = min(light_screen.region_min, light_screen.region_min + away);
    let high = max(light_screen.region_max, light_screen.region_max + away);
    let half_pixel = 0.5 * (high - low) / (light_screen.screen_px - 1.0);
    return vec4f(low - half_pixel, high + half_pixel);
}

/// Where on the screen, from 0 to 1, the light comes through that would reach a point straight.
fn screen_uv(p: vec3f) -> vec2f {
    let corners = screen_corners();
    let slope = sun.direction.xz / min(sun.direction.y, LOWEST);
    return (p.xz + slope * (light_screen.top_m - p.y) - corners.xy) / (corners.zw - corners.xy);
}

/// Metres that light travels from the screen straight to a point.
fn screen_path(p: vec3f) -> f32 {
    return (p.y - light_screen.top_m) / min(sun.direction.y, LOWEST);
}

/// The point at the end of such a path.
fn screen_point(uv: vec2f, path_m: f32) -> vec3f {
    let corners = screen_corners();
    let on_screen = mix(corners.xy, corners.zw, uv);
    return vec3f(on_screen.x, light_screen.top_m, on_screen.y) + path_m * sun.direction;
}
