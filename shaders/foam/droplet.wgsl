// A droplet of white water: a soft capsule along its motion on the screen, lit as something that scatters all ways. Below
// the liquid's surface it is seen where the surface bends its light from, and dimmed by the liquid before it. Blended in
// any order (McGuire and Bavoil 2013: light by weight, and what stays clear).
#import "lib/camera.wgsl"
#import "lib/harmonics.wgsl"
#import "lib/light.wgsl"
#import "lib/optics.wgsl"
#import "lib/packed.wgsl"
#import "lib/scatter.wgsl"

struct Params {
    albedo: vec3f,
    absorption: vec3f,
    ior: f32,
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
/// How far apart the surface is looked at for its slope.
const SLOPE_PX = 2;
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
    let there = eye_from_world_point(unpack3(points_position[particle]) + offset);
    let moved = (camera.view_from_world * vec4f(unpack3(points_velocity[particle]), 0.0)).xyz * params.shutter;

    var out: Droplet;
    if there.z > -2.0 * camera.near {
        out.clip = vec4f(2.0, 2.0, 0.5, 1.0);
        return out;
    }
    let image = seen_at(there);
    let p = image.xyz;
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
    // The same water over a larger area is the thinner: 16 / 3π is what the capsule's middle holds against its ends.
    let grown = radius_m / shown_m;
    out.opacity = params.opacity * image.w * grown * grown / (1.0 + 1.6976527 * out.reach);
    out.z = there.z;
    return out;
}

/// Where a point is seen, and the share of its light that comes through. Below the liquid's surface that is its image by
/// rays near the surface's normal: as much nearer to the surface as the index of refraction says.
fn seen_at(p: vec3f) -> vec4f {
    let pixel = pixel_from_eye(p);
    if !on_screen(pixel) {
        return vec4f(p, 1.0);
    }
    let texel = vec2i(pixel);
    let liquid = textureLoad(layers, texel, 0).xy;
    if liquid.x <= p.z || liquid.x == 0.0 {
        return vec4f(p, 1.0);
    }
    let surface = eye_from_pixel(pixel, liquid.x);
    let normal = slope(texel, liquid.x);
    let view = normalize(eye_ray(pixel).direction);
    let through = 1.0 - fresnel(clamp(-dot(normal, view), 0.01, 1.0), params.ior);
    // What lies behind the liquid is seen through two surfaces, which shift it little.
    let is_inside = liquid.y == 0.0 || p.z > liquid.y;
    let below_m = select(0.0, max(dot(surface - p, normal), 0.0), is_inside);
    return vec4f(p + normal * below_m * (1.0 - 1.0 / params.ior), through);
}

/// Normal of the liquid's front from its depth around; towards the eye where the depth jumps.
fn slope(texel: vec2i, z: f32) -> vec3f {
    let right = along_front(texel, z, vec2i(SLOPE_PX, 0));
    let up = along_front(texel, z, vec2i(0, -SLOPE_PX));
    let crossed = cross(right, up);
    let squared = dot(crossed, crossed);
    let back = -normalize(eye_ray(vec2f(texel) + 0.5).direction);
    return select(back, crossed * inverseSqrt(max(squared, 1.0e-30)), squared > 0.0);
}

/// Change of the front's point along a step of pixels; none where it ends or jumps.
fn along_front(texel: vec2i, z: f32, step: vec2i) -> vec3f {
    let end = vec2i(camera.viewport) - 1;
    let ends = vec4i(clamp(texel - step, vec2i(0), end), clamp(texel + step, vec2i(0), end));
    let zs = vec2f(textureLoad(layers, ends.xy, 0).x, textureLoad(layers, ends.zw, 0).x);
    if any(zs == vec2f(0.0)) || any(abs(zs - z) > vec2f(4.0 * params.particles_radius)) {
        return vec3f(0.0);
    }
    return eye_from_pixel(vec2f(ends.zw) + 0.5, zs.y) - eye_from_pixel(vec2f(ends.xy) + 0.5, zs.x);
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
    // What the liquid takes on the way to the eye, and as much again on the light's way in. Without a back it has no end.
    let thick = select(liquid.x - liquid.y, 1.0e30, liquid.y == 0.0);
    let behind = select(0.0, min(liquid.x - in.z, thick), liquid.x != 0.0);
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
