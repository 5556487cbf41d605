// Floor and box in sun and sky light: premultiplied colour, the floor fading out with the distance.
#import "dry_scene/skylight.wgsl"
#import "dry_scene/sunlight.wgsl"
#import "lib/camera.wgsl"

struct Params {
    floor: u32,
    floor_m: f32,
    floor_radius_m: f32,
    middle: vec2f,
    tile_m: f32,
    floor_color: vec3f,
    box: u32,
    box_min: vec3f,
    box_max: vec3f,
    box_color: vec3f,
}

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) @interpolate(flat) normal: vec3f,
    @location(2) @interpolate(flat) is_box: u32,
}

const FLOOR_VERTICES = 6u;

var<uniform> params: Params;

/// A corner of a square from -1 to 1: two triangles, six vertices.
fn corner(index: u32) -> vec2f {
    let right = index == 1u || index == 2u || index == 4u;
    let up = index == 2u || index == 4u || index == 5u;
    return select(vec2f(-1.0), vec2f(1.0), vec2<bool>(right, up));
}

/// Vertices 0 to 5 are the floor, 6 to 41 the box's faces; what is switched off shrinks to a point.
fn dry_corner(index: u32) -> Vertex {
    var out: Vertex;
    if index < FLOOR_VERTICES {
        let at = params.middle + params.floor_radius_m * f32(params.floor) * corner(index);
        out.world = vec3f(at.x, params.floor_m, at.y);
        out.normal = vec3f(0.0, 1.0, 0.0);
    } else {
        let face = (index - FLOOR_VERTICES) / 6u;
        let at = corner((index - FLOOR_VERTICES) % 6u);
        let side = select(-1.0, 1.0, (face & 1u) == 1u);
        var unit = vec3f(side, at.x, at.y);
        var normal = vec3f(side, 0.0, 0.0);
        for (var turn = 0u; turn < face / 2u; turn++) {
            unit = unit.zxy;
            normal = normal.zxy;
        }
        let extent = 0.5 * (params.box_max - params.box_min) * f32(params.box);
        out.world = 0.5 * (params.box_min + params.box_max) + extent * unit;
        out.normal = normal;
        out.is_box = 1u;
    }
    out.clip = camera.clip_from_world * vec4f(out.world, 1.0);
    return out;
}

/// Share of the light squares of a chequered floor, averaged over the pixel's footprint so that it never flickers.
fn checker(at: vec2f) -> f32 {
    let footprint = max(fwidth(at), vec2f(1.0e-5));
    let low = at - 0.5 * footprint;
    let high = at + 0.5 * footprint;
    // The integral of a square wave between -1 and 1.
    let area = (abs(fract(0.5 * high) - 0.5) - abs(fract(0.5 * low) - 0.5)) * 4.0 / footprint;
    let wave = clamp(area, vec2f(-1.0), vec2f(1.0));
    return 0.5 + 0.5 * wave.x * wave.y;
}

fn dry_color(in: Vertex, through: vec3f) -> vec4f {
    let square = checker(in.world.xz / params.tile_m);
    var albedo = params.box_color;
    var alpha = 1.0;
    if in.is_box == 0u {
        albedo = params.floor_color * mix(0.84, 1.0, square);
        let away = length(in.world.xz - params.middle) / params.floor_radius_m;
        alpha = 1.0 - smoothstep(0.35, 1.0, away);
    }
    let light = sky_irradiance(in.normal) + from_sun(in.world, in.normal, through);
    return vec4f(albedo * light / 3.14159265 * alpha, alpha);
}
