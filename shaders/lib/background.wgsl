// What is seen from a point in a direction past the liquid: the dry scene where the ray meets it on the screen, else
// the sky (b() of Imai 2016, equations 6 to 8).
#import "lib/camera.wgsl"

var dry_color: texture_2d<f32>;
var dry_z: texture_2d<f32>;
var sky_cube: texture_cube<f32>;
var linear_clamp: sampler;

/// Rays whose background is still to be added to the light: gathered first and followed in one place, which keeps
/// shaders short to compile. Two pairs of surfaces give three each, and the last ray goes on.
struct Rays {
    count: u32,
    p: array<vec3f, 7>,
    direction: array<vec3f, 7>,
    share: array<vec3f, 7>,
}

const RAYS_MAX = 7u;

fn sky_towards(direction: vec3f) -> vec3f {
    return textureSampleLevel(sky_cube, linear_clamp, world_from_eye_vector(direction), 0.0).rgb;
}

/// The dry scene at a pixel, premultiplied.
fn dry_at(pixel: vec2f) -> vec4f {
    return textureSampleLevel(dry_color, linear_clamp, pixel / camera.viewport, 0.0);
}

fn dry_z_at(pixel: vec2f) -> f32 {
    return textureLoad(dry_z, clamp(vec2i(pixel), vec2i(0), vec2i(camera.viewport) - 1), 0).x;
}

/// How far a point is from the dry scene behind its pixel, measured across the surface there; huge where nothing is.
fn dry_distance(p: vec3f, pixel: vec2f) -> f32 {
    let texel = clamp(vec2i(pixel), vec2i(0), vec2i(camera.viewport) - 2);
    let z = textureLoad(dry_z, texel, 0).x;
    if z == 0.0 {
        return 1.0e30;
    }
    let here = eye_from_pixel(vec2f(texel) + 0.5, z);
    let right = eye_from_pixel(vec2f(texel) + vec2f(1.5, 0.5), textureLoad(dry_z, texel + vec2i(1, 0), 0).x) - here;
    let down = eye_from_pixel(vec2f(texel) + vec2f(0.5, 1.5), textureLoad(dry_z, texel + vec2i(0, 1), 0).x) - here;
    let crossed = cross(down, right);
    return dot(crossed * inverseSqrt(max(dot(crossed, crossed), 1.0e-30)), p - here);
}

/// 1 where a point lies on the dry scene behind its pixel, 0 from `contact` on: liquid that rests on something wets it,
/// so that no air and no second surface lies between. Never where `contact` is 0.
fn wetting(p: vec3f, pixel: vec2f, contact: f32) -> f32 {
    if contact <= 0.0 {
        return 0.0;
    }
    return 1.0 - smoothstep(0.5 * contact, contact, dry_distance(p, pixel));
}

/// Marches in growing steps until the ray is behind the dry scene, then halves the last step. All in eye space.
fn background(p: vec3f, direction: vec3f, reach: f32, steps: u32) -> vec3f {
    var ends = vec2f(0.0);
    var found = false;
    for (var k = 0u; k <= steps; k++) {
        let share = f32(k) / f32(steps);
        let t = reach * share * share;
        let q = p + t * direction;
        let pixel = pixel_from_eye(q);
        if q.z > -camera.near || !on_screen(pixel) {
            break;
        }
        let z = textureLoad(dry_z, vec2i(pixel), 0).x;
        ends = vec2f(ends.y, t);
        if z != 0.0 && q.z <= z {
            found = true;
            break;
        }
    }
    var dry = vec4f(0.0);
    if found {
        let stride = ends.y - ends.x;
        for (var k = 0u; k < steps / 3u; k++) {
            let middle = 0.5 * (ends.x + ends.y);
            let m = p + middle * direction;
            let z = dry_z_at(pixel_from_eye(m));
            ends = select(vec2f(middle, ends.y), vec2f(ends.x, middle), z != 0.0 && m.z <= z);
        }
        let hit = p + ends.y * direction;
        let at = pixel_from_eye(hit);
        // A ray that passes far behind something has not met it.
        if dry_z_at(at) - hit.z <= 0.25 * stride + 0.01 * reach {
            dry = dry_at(at);
        }
    }
    return dry.rgb + (1.0 - dry.a) * sky_towards(direction);
}

fn add_ray(rays: ptr<function, Rays>, p: vec3f, direction: vec3f, share: vec3f) {
    let i = (*rays).count;
    if any(share > vec3f(0.0)) && i < RAYS_MAX {
        (*rays).p[i] = p;
        (*rays).direction[i] = direction;
        (*rays).share[i] = share;
        (*rays).count = i + 1u;
    }
}

/// The light of all rays, each by its share.
fn gathered(rays: ptr<function, Rays>, reach: f32, steps: u32) -> vec3f {
    var light = vec3f(0.0);
    for (var i = 0u; i < (*rays).count; i++) {
        light += (*rays).share[i] * background((*rays).p[i], (*rays).direction[i], reach, steps);
    }
    return light;
}
