// Meshes in sun and sky light by glTF 2.0's metallic-roughness model (appendix B): Lambert and GGX for the sun, the
// sky's irradiance and its prefiltered picture for the rest. Who imports this says how much light there is at a place.
#import "lib/camera.wgsl"
#import "lib/linear_clamp.wgsl"
#import "lib/mesh_place.wgsl"
#import "lib/surface_light.wgsl"

struct Prefiltered {
    specular_levels: u32,
}

struct Material {
    base_color_factor: vec4f,
    metallic_factor: f32,
    roughness_factor: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    emissive_factor: vec3f,
    emissive_strength: f32,
    alpha_mode: u32,
    alpha_cutoff: f32,
    unlit: u32,
    ior: f32,
    base_color_transform: mat3x3f,
    metallic_roughness_transform: mat3x3f,
    normal_transform: mat3x3f,
    occlusion_transform: mat3x3f,
    emissive_transform: mat3x3f,
    base_color_texcoord: u32,
    metallic_roughness_texcoord: u32,
    normal_texcoord: u32,
    occlusion_texcoord: u32,
    emissive_texcoord: u32,
}

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv0: vec2f,
    @location(4) uv1: vec2f,
    @location(5) color: vec4f,
}

/// What a mesh brings for each corner.
struct Corner {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv0: vec2f,
    @location(4) uv1: vec2f,
    @location(5) color0: vec4f,
    @location(6) instance: u32,
}

const PI = 3.14159265;

var<uniform> prefiltered: Prefiltered;
var<uniform> material: Material;
var base_color_texture: texture_2d<f32>;
var base_color_sampler: sampler;
var metallic_roughness_texture: texture_2d<f32>;
var metallic_roughness_sampler: sampler;
var normal_texture: texture_2d<f32>;
var normal_sampler: sampler;
var occlusion_texture: texture_2d<f32>;
var occlusion_sampler: sampler;
var emissive_texture: texture_2d<f32>;
var emissive_sampler: sampler;
var specular_specular: texture_cube<f32>;

fn mesh_vertex(in: Corner) -> Vertex {
    var out = mesh_corner(placed(in.position, in.normal, in.instance), in);
    out.clip = camera.clip_from_world * vec4f(out.world, 1.0);
    return out;
}

/// All but where it is seen.
fn mesh_corner(at: Placed, in: Corner) -> Vertex {
    var out: Vertex;
    out.world = at.world;
    out.normal = at.normal;
    out.tangent = vec4f((world_from_mesh(in.instance) * vec4f(in.tangent.xyz, 0.0)).xyz, in.tangent.w);
    out.uv0 = in.uv0;
    out.uv1 = in.uv1;
    out.color = in.color0;
    return out;
}

fn uv(in: Vertex, texcoord: u32, transform: mat3x3f) -> vec2f {
    return (transform * vec3f(select(in.uv0, in.uv1, texcoord == 1u), 1.0)).xy;
}

/// The surface's normal with what the normal texture adds; `facing` is -1 for the back of a sheet.
fn bumped(in: Vertex, texel: vec3f, facing: f32) -> vec3f {
    let normal = normalize(in.normal);
    let along = in.tangent.xyz - normal * dot(in.tangent.xyz, normal);
    if dot(along, along) < 1.0e-12 {
        return normal * facing;
    }
    let tangent = normalize(along);
    let bitangent = in.tangent.w * cross(normal, tangent);
    let bump = (texel * 2.0 - 1.0) * vec3f(material.normal_scale, material.normal_scale, 1.0);
    return facing * normalize(bump.x * tangent + bump.y * bitangent + bump.z * normal);
}

/// GGX with Smith's visibility: what a light sends to the eye, without its colour and cosine.
fn ggx(normal: vec3f, to_eye: vec3f, to_light: vec3f, alpha: f32, f0: vec3f) -> vec3f {
    let half = normalize(to_eye + to_light);
    let nh = clamp(dot(normal, half), 0.0, 1.0);
    let nv = max(dot(normal, to_eye), 1.0e-4);
    let nl = max(dot(normal, to_light), 1.0e-4);
    let squared = alpha * alpha;
    let spread = nh * nh * (squared - 1.0) + 1.0;
    let distribution = squared / (PI * spread * spread);
    let visibility = 0.5 / (nl * sqrt(nv * nv * (1.0 - squared) + squared) + nv * sqrt(nl * nl * (1.0 - squared) + squared));
    let rest = 1.0 - clamp(dot(to_eye, half), 0.0, 1.0);
    let fresnel = f0 + (1.0 - f0) * rest * rest * rest * rest * rest;
    return fresnel * distribution * visibility;
}

/// How much of the prefiltered sky is mirrored: an empirical fit of the integral (Karis 2014, for mobile devices), and
/// what rough surfaces send on after bouncing between their facets, which the fit leaves out (Lagarde and Golubev 2018).
fn sky_mirrored(f0: vec3f, roughness: f32, nv: f32) -> vec3f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    let scale = -1.04 * a + r.z;
    let bias = 1.04 * a + r.w;
    return clamp((f0 * scale + bias) * (1.0 + f0 * (1.0 / max(scale + bias, 0.05) - 1.0)), vec3f(0.0), vec3f(1.0));
}

/// From a place to the eye; of a parallel view the eye is infinitely far behind the viewer.
fn towards_eye(p: vec3f) -> vec3f {
    return normalize(select(camera.position - p, world_from_eye_vector(vec3f(0.0, 0.0, 1.0)), camera.orthographic != 0u));
}

/// A place of a mesh, with its material.
struct Surface {
    base: vec4f,
    emitted: vec3f,
    metallic: f32,
    roughness: f32,
    occlusion: f32,
    normal: vec3f,
    // The triangles' own.
    geometric: vec3f,
}

/// The material at a fragment, which is discarded where the material has holes.
fn mesh_surface(in: Vertex, is_front: bool) -> Surface {
    let base = material.base_color_factor * in.color
        * textureSample(base_color_texture, base_color_sampler, uv(in, material.base_color_texcoord, material.base_color_transform));
    let rough_metal = textureSample(metallic_roughness_texture, metallic_roughness_sampler,
        uv(in, material.metallic_roughness_texcoord, material.metallic_roughness_transform));
    let bump = textureSample(normal_texture, normal_sampler, uv(in, material.normal_texcoord, material.normal_transform));
    let occluded = textureSample(occlusion_texture, occlusion_sampler,
        uv(in, material.occlusion_texcoord, material.occlusion_transform)).r;
    let glow = textureSample(emissive_texture, emissive_sampler, uv(in, material.emissive_texcoord, material.emissive_transform));

    if material.alpha_mode == 1u && base.a < material.alpha_cutoff {
        discard;
    }
    let facing = select(-1.0, 1.0, is_front);
    var out: Surface;
    out.base = vec4f(base.rgb, select(1.0, base.a, material.alpha_mode == 2u));
    out.emitted = material.emissive_factor * material.emissive_strength * glow.rgb;
    out.metallic = material.metallic_factor * rough_metal.b;
    out.roughness = clamp(material.roughness_factor * rough_metal.g, 0.04, 1.0);
    out.occlusion = 1.0 + material.occlusion_strength * (occluded - 1.0);
    out.normal = bumped(in, bump.xyz, facing);
    out.geometric = normalize(in.normal) * facing;
    return out;
}

/// What a surface in some light sends to an eye, premultiplied.
fn mesh_color(surface: Surface, light: SurfaceLight, to_eye: vec3f) -> vec4f {
    let base = surface.base.rgb;
    let alpha = surface.base.a;
    if material.unlit != 0u {
        return vec4f(base * alpha, alpha);
    }
    let roughness = surface.roughness;
    let ratio = (material.ior - 1.0) / (material.ior + 1.0);
    let f0 = mix(vec3f(ratio * ratio), base, surface.metallic);
    let normal = surface.normal;
    let nv = clamp(dot(normal, to_eye), 0.0, 1.0);
    let mirrored = textureSampleLevel(specular_specular, linear_clamp, reflect(-to_eye, normal),
        roughness * f32(prefiltered.specular_levels - 1u)).rgb;
    let share = sky_mirrored(f0, roughness, nv);
    // What is mirrored at the surface is not scattered below it; only the part that is no metal scatters.
    let scattered = (1.0 - sky_mirrored(vec3f(ratio * ratio), roughness, nv)) * base * (1.0 - surface.metallic) / PI;
    let from_sky = scattered * light.sky + share * light.mirrored * mirrored;
    let from_sun = light.sun * select(0.0, 1.0, dot(surface.geometric, light.towards_sun) > 0.0);
    let direct = (scattered + ggx(normal, to_eye, light.towards_sun, roughness * roughness, f0)) * from_sun;
    let color = from_sky * surface.occlusion + direct + surface.emitted;
    return vec4f(min(color, vec3f(60000.0)) * alpha, alpha);
}
