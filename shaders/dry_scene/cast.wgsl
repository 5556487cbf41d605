// What the sun sees of the meshes: how near each point is. Holes of masked materials let light through.
#import "lib/light.wgsl"
#import "lib/mesh_place.wgsl"
#import "lib/sun_view.wgsl"

struct Params {
    cast_middle: vec3f,
    cast_radius_m: f32,
}

struct Material {
    base_color_factor: vec4f,
    base_color_transform: mat3x3f,
    base_color_texcoord: u32,
    alpha_mode: u32,
    alpha_cutoff: f32,
}

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
    @location(1) alpha: f32,
}

var<uniform> params: Params;
var<uniform> sun: Light;
var<uniform> material: Material;
var base_color_texture: texture_2d<f32>;
var base_color_sampler: sampler;

@vertex
fn seen_by_sun(
    @location(0) position: vec3f,
    @location(1) uv0: vec2f,
    @location(2) uv1: vec2f,
    @location(3) color0: vec4f,
    @location(4) instance: u32,
) -> Vertex {
    let world = world_from_mesh(instance) * vec4f(position, 1.0);
    let uv = select(uv0, uv1, material.base_color_texcoord == 1u);
    var out: Vertex;
    out.clip = vec4f(sun_view(world.xyz, params.cast_middle, params.cast_radius_m, sun.direction), 1.0);
    out.uv = (material.base_color_transform * vec3f(uv, 1.0)).xy;
    out.alpha = material.base_color_factor.a * color0.a;
    return out;
}

@fragment
fn holes(in: Vertex) {
    let alpha = in.alpha * textureSample(base_color_texture, base_color_sampler, in.uv).a;
    // What blends casts a shadow where it covers more than half.
    let cutoff = select(material.alpha_cutoff, 0.5, material.alpha_mode == 2u);
    if material.alpha_mode != 0u && alpha < cutoff {
        discard;
    }
}
