// An ellipsoid as the light sees it on the virtual screen, ray-cast along the light.
#import "lib/ellipsoid.wgsl"
#import "lib/light_screen.wgsl"

struct Ids {
    count: u32,
    items: array<u32>,
}

struct Shape {
    @builtin(position) clip: vec4f,
    // Rows that take the world to the space in which it is the unit sphere, and its centre.
    @location(0) @interpolate(flat) to_unit_x: vec3f,
    @location(1) @interpolate(flat) to_unit_y: vec3f,
    @location(2) @interpolate(flat) to_unit_z: vec3f,
    @location(3) @interpolate(flat) centre: vec3f,
    // Where the ray goes through the screen.
    @location(4) at: vec2f,
}

struct LightHit {
    // How near the ray passes the centre, squared: above 1 it misses.
    away_2: f32,
    path_m: f32,
    normal: vec3f,
}

var<storage, read> ids: Ids;
var<storage, read> ellipsoid: array<Ellipsoid>;

/// A corner of the quad around an ellipsoid on the screen.
fn shape_on_screen(instance: u32, corner: u32) -> Shape {
    let e = ellipsoid[ids.items[instance]];
    let axes = ellipsoid_axes(e);
    let slope = sun.direction.xz / min(sun.direction.y, LOWEST);
    // Going along the light, x and z on the screen are linear in the place.
    let across = array<vec3f, 2>(vec3f(1.0, -slope.x, 0.0), vec3f(0.0, -slope.y, 1.0));
    let reach = vec2f(length(across[0] * axes), length(across[1] * axes));
    let side = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    var out: Shape;
    out.centre = ellipsoid_centre(e);
    out.to_unit_x = axes[0] / dot(axes[0], axes[0]);
    out.to_unit_y = axes[1] / dot(axes[1], axes[1]);
    out.to_unit_z = axes[2] / dot(axes[2], axes[2]);
    out.at = out.centre.xz + slope * (light_screen.top_m - out.centre.y) + reach * side;
    let corners = screen_corners();
    let uv = (out.at - corners.xy) / (corners.zw - corners.xy);
    out.clip = vec4f(uv.x * 2.0 - 1.0, 1.0 - 2.0 * uv.y, 0.5, 1.0);
    if !sun_shines() {
        out.clip = vec4f(2.0, 2.0, 0.5, 1.0);
    }
    return out;
}

fn to_unit(in: Shape, v: vec3f) -> vec3f {
    return vec3f(dot(in.to_unit_x, v), dot(in.to_unit_y, v), dot(in.to_unit_z, v));
}

/// Where the light first meets the ellipsoid.
fn met_by_light(in: Shape) -> LightHit {
    let start = to_unit(in, vec3f(in.at.x, light_screen.top_m, in.at.y) - in.centre);
    let along = to_unit(in, sun.direction);
    let along_2 = dot(along, along);
    let nearest = -dot(start, along) / along_2;
    let closest = start + nearest * along;
    let away_2 = dot(closest, closest);
    let path = nearest - sqrt(max(1.0 - away_2, 0.0) / along_2);
    let unit = start + path * along;
    let normal = unit.x * in.to_unit_x + unit.y * in.to_unit_y + unit.z * in.to_unit_z;
    return LightHit(away_2, path, normalize(normal));
}

/// Reversed depth of a path: 1 well above the screen, 0 well below the ground.
fn depth_of_path(path_m: f32) -> f32 {
    let far = 2.0 * screen_path(vec3f(0.0, light_screen.bottom_m, 0.0));
    return clamp(0.75 - 0.75 * path_m / far, 0.0, 1.0);
}
