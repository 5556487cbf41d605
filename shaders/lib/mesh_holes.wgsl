// Where meshes let the sun's light through: holes of masked materials, and what blends and covers less than half.

struct Material {
    base_color_factor: vec4f,
    base_color_transform: mat3x3f,
    base_color_texcoord: u32,
    alpha_mode: u32,
    alpha_cutoff: f32,
}

var<uniform> material: Material;
var base_color_texture: texture_2d<f32>;
var base_color_sampler: sampler;

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
    // Of the vertex' colour.
    @location(1) alpha: f32,
}

/// Where the material's picture is looked up.
fn holes_uv(uv0: vec2f, uv1: vec2f) -> vec2f {
    let uv = select(uv0, uv1, material.base_color_texcoord == 1u);
    return (material.base_color_transform * vec3f(uv, 1.0)).xy;
}

/// Discards the fragment where the light passes.
fn discard_holes(in: Vertex) {
    let texel = textureSample(base_color_texture, base_color_sampler, in.uv);
    let covers = material.base_color_factor.a * in.alpha * texel.a;
    let cutoff = select(material.alpha_cutoff, 0.5, material.alpha_mode == 2u);
    if material.alpha_mode != 0u && covers < cutoff {
        discard;
    }
}
