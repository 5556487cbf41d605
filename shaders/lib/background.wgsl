// What is seen from a point in a direction past the liquid: the dry scene where the ray meets it on the screen, else
// the sky (b() of Imai 2016, equations 6 to 8).
#import "lib/camera.wgsl"

/// Whether anything stands on the floor, and so may stand in the liquid.
override dry_stands: bool = true;

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

/// Where a ray meets the dry scene, in metres: the last place before it, and one behind it. `hidden` if it ends behind
/// something that it did not meet: then `behind` is where it comes nearest to what is seen there.
struct Meeting {
    found: bool,
    hidden: bool,
    before: f32,
    behind: f32,
}

/// Marches in growing steps until the ray is behind the dry scene, and halves the step. All in eye space. A ray that
/// goes on behind something and comes out behind what is farther takes that: it met it where it cannot be seen.
fn meet_dry(p: vec3f, direction: vec3f, reach: f32, steps: u32) -> Meeting {
    var ends = vec2f(0.0);
    var was_behind = false;
    var least = 1.0e30;
    // What was seen before the last place behind it, and how far that place was behind.
    var last = vec2f(0.0);
    var meeting = Meeting(false, false, 0.0, 0.0);
    for (var k = 0u; k <= steps; k++) {
        let share = f32(k) / f32(steps);
        let t = reach * share * share;
        let q = p + t * direction;
        let pixel = pixel_from_eye(q);
        if q.z > -camera.near || !on_screen(pixel) {
            break;
        }
        ends = vec2f(ends.y, t);
        let z = textureLoad(dry_z, vec2i(pixel), 0).x;
        if z == 0.0 || q.z > z {
            was_behind = false;
            continue;
        }
        let between = select(halved(p, direction, ends, steps / 3u), ends, was_behind);
        let hit = p + between.y * direction;
        let gap = dry_z_at(pixel_from_eye(hit)) - hit.z;
        // A ray that passes far behind something has not met it.
        if gap <= 0.25 * (ends.y - ends.x) + 0.01 * reach {
            return Meeting(true, false, between.x, between.y);
        }
        if gap < least || (was_behind && z < last.x - 0.5 * last.y) {
            least = gap;
            meeting.behind = between.y;
        }
        last = vec2f(z, gap);
        was_behind = true;
    }
    meeting.hidden = was_behind;
    return meeting;
}

/// The last step before a ray is behind the dry scene, halved so many times.
fn halved(p: vec3f, direction: vec3f, step: vec2f, times: u32) -> vec2f {
    var ends = step;
    for (var k = 0u; k < times; k++) {
        let middle = 0.5 * (ends.x + ends.y);
        let m = p + middle * direction;
        let z = dry_z_at(pixel_from_eye(m));
        ends = select(vec2f(middle, ends.y), vec2f(ends.x, middle), z != 0.0 && m.z <= z);
    }
    return ends;
}

/// What stands in the liquid, met by a ray on the way to where it would leave.
fn stands_within(p: vec3f, direction: vec3f, leaves: f32, steps: u32) -> Meeting {
    if !dry_stands {
        return Meeting(false, false, 0.0, 0.0);
    }
    return meet_dry(p, direction, leaves, steps);
}

fn background(p: vec3f, direction: vec3f, reach: f32, steps: u32) -> vec3f {
    let meeting = meet_dry(p, direction, reach, steps);
    var dry = vec4f(0.0);
    if meeting.found || meeting.hidden {
        dry = dry_at(pixel_from_eye(p + meeting.behind * direction));
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
