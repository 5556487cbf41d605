// What the sun sees of the meshes: how near each point is. Holes of masked materials let light through.
#import "lib/light.wgsl"
#import "lib/mesh_holes.wgsl"
#import "lib/mesh_place.wgsl"
#import "lib/sun_view.wgsl"

struct Params {
    cast_middle: vec3f,
    cast_radius_m: f32,
}

var<uniform> params: Params;
var<uniform> sun: Light;

@vertex
fn seen_by_sun(
    @location(0) position: vec3f,
    @location(1) uv0: vec2f,
    @location(2) uv1: vec2f,
    @location(3) color0: vec4f,
    @location(4) instance: u32,
) -> Vertex {
    let world = world_from_mesh(instance) * vec4f(position, 1.0);
    var out: Vertex;
    out.clip = vec4f(sun_view(world.xyz, params.cast_middle, params.cast_radius_m, sun.direction), 1.0);
    out.uv = holes_uv(uv0, uv1);
    out.alpha = color0.a;
    return out;
}

@fragment
fn holes(in: Vertex) {
    discard_holes(in);
}
