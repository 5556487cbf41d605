// A droplet of white water: a soft capsule along its motion on the screen, lit as something that scatters all ways, and
// dimmed by the liquid before it. Blended in any order (McGuire and Bavoil 2013: light by weight, and what stays clear).
#import "lib/camera.wgsl"
#import "lib/harmonics.wgsl"
#import "lib/light.wgsl"
#import "lib/packed.wgsl"
#import "lib/scatter.wgsl"

struct Params {
    albedo: vec3f,
    absorption: vec3f,
    shutter: f32,
    droplets: u32,
    spread: f32,
    size: f32,
    opacity: f32,
    particles_radius: f32,
}

struct Droplet {
    @builtin(position) clip: vec4f,
    // In units of the capsule's radius, from the middle: along the motion and across it.
    @location(0) at: vec2f,
    // Half of the way between the capsule's two centres, in the same units.
    @location(1) @interpolate(flat) reach: f32,
    @location(2) @interpolate(flat) opacity: f32,
    @location(3) @interpolate(flat) z: f32,
}

struct Blended {
    @location(0) light: vec4f,
    @location(1) clear: f32,
}

/// A droplet smaller than this is drawn so large, and the fainter for it.
const SMALLEST_PX = 0.75;
/// No smear goes over more of the picture than this.
const LONGEST_PX = 64.0;
/// Sizes of a particle's droplets, against their mean.
const SIZES = vec2f(0.45, 1.55);

var<uniform> params: Params;
var<uniform> sun: Light;
var<storage, read> ambient: array<vec4f>;
var<storage, read> points_position: array<Packed3>;
var<storage, read> points_velocity: array<Packed3>;
var layers: texture_2d<f32>;
var dry_z: texture_2d<f32>;

@vertex
fn quad(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Droplet {
    let particle = instance / params.droplets;
    let part = instance % params.droplets;
    let chance = scattered(vec3u(particle, part, 1u));
    // Evenly in a ball: a direction, and the third root for the distance.
    let turn = scattered(vec3u(particle, part, 2u));
    let up = 2.0 * chance.x - 1.0;
    let across = sqrt(max(1.0 - up * up, 0.0));
    let direction = vec3f(across * cos(6.2831853 * chance.y), up, across * sin(6.2831853 * chance.y));
    let away = params.spread * params.particles_radius * pow(turn.x, 1.0 / 3.0);
    // The first droplet is the particle itself.
    let offset = select(away * direction, vec3f(0.0), part == 0u);
    let p = eye_from_world_point(unpack3(points_position[particle]) + offset);
    let moved = (camera.view_from_world * vec4f(unpack3(points_velocity[particle]), 0.0)).xyz * params.shutter;

    var out: Droplet;
    if p.z > -2.0 * camera.near {
        out.clip = vec4f(2.0, 2.0, 0.5, 1.0);
        return out;
    }
    let pixel_m = pixel_width(p.z);
    let radius_m = params.size * params.particles_radius * mix(SIZES.x, SIZES.y, turn.y * turn.y);
    let shown_m = max(radius_m, SMALLEST_PX * pixel_m);
    let smear = moved.xy - p.xy / p.z * moved.z * select(1.0, 0.0, camera.orthographic != 0u);
    let half_m = min(0.5 * length(smear), LONGEST_PX * pixel_m);
    let along = select(vec2f(1.0, 0.0), normalize(smear), half_m > 1.0e-9);
    out.reach = half_m / shown_m;
    out.at = (vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0) * vec2f(1.0 + out.reach, 1.0);
    let side = vec2f(-along.y, along.x);
    let q = vec3f(p.xy + shown_m * (out.at.x * along + out.at.y * side), p.z);
    out.clip = camera.clip_from_view * vec4f(q, 1.0);
    // The same water over a larger area is the thinner.
    let grown = radius_m / shown_m;
    out.opacity = params.opacity * grown * grown / (1.0 + 1.2732395 * out.reach);
    out.z = p.z;
    return out;
}

/// Metres that a pixel covers at eye z.
fn pixel_width(z: f32) -> f32 {
    let scale = 2.0 / (camera.clip_from_view[1][1] * camera.viewport.y);
    return scale * select(-z, 1.0, camera.orthographic != 0u);
}

@fragment
fn light(in: Droplet) -> Blended {
    let past = vec2f(max(abs(in.at.x) - in.reach, 0.0), in.at.y);
    let profile = max(1.0 - dot(past, past), 0.0);
    let alpha = in.opacity * profile;
    let texel = vec2i(in.clip.xy);
    let dry = textureLoad(dry_z, texel, 0).x;
    if alpha < 1.0e-3 || (dry != 0.0 && dry > in.z) {
        discard;
    }
    let liquid = textureLoad(layers, texel, 0).xy;
    // What the liquid takes on the way to the eye, and as much again on the light's way in.
    let behind = select(0.0, min(liquid.x - in.z, liquid.x - liquid.y), liquid.x != 0.0);
    let ray = eye_ray(in.clip.xy).direction;
    let path_m = max(behind, 0.0) * length(ray);
    let through = exp(-2.0 * params.absorption * path_m);
    let weight = alpha * clamp(1.0 / (1.0e-3 + in.z * in.z), 1.0e-2, 1.0e2);
    return Blended(vec4f(radiance() * through, 1.0) * weight, 1.0 - alpha);
}

/// Of something white that scatters light to all sides: the mean of the irradiance around it.
fn radiance() -> vec3f {
    // Of the harmonics only the constant one has a mean.
    let sky = max(ambient[0].rgb * 0.282095, vec3f(0.0));
    return params.albedo * (0.5 * irradiance(sun) + sky) / 3.14159265;
}
