// A mesh's matt colour in the light of the sample planes and the sky.
#import "lib/caustic_planes.wgsl"

struct Material {
    base_color_factor: vec4f,
    alpha_mode: u32,
    alpha_cutoff: f32,
}

const MASK = 1u;

var<uniform> material: Material;
var base_color_texture: texture_2d<f32>;
var base_color_sampler: sampler;

/// Premultiplied; alpha is 0 where the material is cut out. Normals that face away from the viewer are turned round.
fn mesh_color(p: vec3f, normal: vec3f, uv: vec2f, color: vec4f, faces: bool) -> vec4f {
    let base = material.base_color_factor * color * textureSample(base_color_texture, base_color_sampler, uv);
    if material.alpha_mode == MASK && base.a < material.alpha_cutoff {
        return vec4f(0.0);
    }
    let n = normalize(normal) * select(-1.0, 1.0, faces);
    // Off the surface, so that the shadow's coarse heights do not shade what casts it.
    let off_m = (light_screen.region_max.x - light_screen.region_min.x) / 150.0;
    return vec4f(base.rgb * lit(p + off_m * n, n), 1.0);
}
