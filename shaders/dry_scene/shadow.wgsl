// Metres of liquid along the sun's rays: each particle's volume spread over a disc, added up in a picture of the floor
// seen along the rays. Green and blue add up that times its height, and its height squared.
#import "lib/light.wgsl"
#import "lib/packed.wgsl"

struct Params {
    particles_radius: f32,
    floor_m: f32,
    middle: vec2f,
    shadow_m: f32,
    shadow_px: u32,
}

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) at: vec2f,
    @location(1) @interpolate(flat) peak_m: f32,
    // Above the floor, as a share of the picture's width, so that half floats hold its square.
    @location(2) @interpolate(flat) height: f32,
}

var<uniform> params: Params;
var<uniform> sun: Light;
var<storage, read> particles_position: array<Packed3>;

@vertex
fn disc(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Vertex {
    let p = unpack3(particles_position[instance]);
    // A sun at or below the horizon casts no shadow here.
    let fall = (p.y - params.floor_m) / max(-sun.direction.y, 1.0e-3);
    let on_floor = p.xz + sun.direction.xz * fall - params.middle;
    let texel_m = 2.0 * params.shadow_m / f32(params.shadow_px);
    let radius = max(2.0 * params.particles_radius, 1.5 * texel_m);
    var out: Vertex;
    out.at = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    let ndc = (on_floor + radius * out.at) / params.shadow_m;
    out.clip = vec4f(ndc.x, -ndc.y, select(0.5, -1.0, sun.direction.y > -0.02), 1.0);
    let diameter = 2.0 * params.particles_radius;
    // The disc's profile (1 - d²) has half its peak as mean.
    out.peak_m = 2.0 * diameter * diameter * diameter / (3.14159265 * radius * radius);
    out.height = (p.y - params.floor_m) / params.shadow_m;
    return out;
}

@fragment
fn thickness(in: Vertex) -> @location(0) vec4f {
    let depth_m = in.peak_m * max(1.0 - dot(in.at, in.at), 0.0);
    return vec4f(depth_m, depth_m * in.height, depth_m * in.height * in.height, 0.0);
}
