// What is seen from a point in a direction past the liquid: the dry scene where the ray meets it on the screen, else
// the sky (b() of Imai 2016, equations 6 to 8).
#import "lib/camera.wgsl"

var dry_color: texture_2d<f32>;
var dry_z: texture_2d<f32>;
var sky_cube: texture_cube<f32>;
var linear_clamp: sampler;

const DRY_STEPS = 20u;

fn sky_towards(direction: vec3f) -> vec3f {
    return textureSampleLevel(sky_cube, linear_clamp, world_from_eye_vector(direction), 0.0).rgb;
}

/// The dry scene at a pixel (premultiplied) over the sky in a direction.
fn dry_over_sky(pixel: vec2f, direction: vec3f) -> vec3f {
    let dry = textureSampleLevel(dry_color, linear_clamp, pixel / camera.viewport, 0.0);
    return dry.rgb + (1.0 - dry.a) * sky_towards(direction);
}

fn dry_z_at(pixel: vec2f) -> f32 {
    return textureLoad(dry_z, clamp(vec2i(pixel), vec2i(0), vec2i(camera.viewport) - 1), 0).x;
}

/// Marches in growing steps until the ray is behind the dry scene, then halves the last step. All in eye space.
fn background(p: vec3f, direction: vec3f, reach: f32) -> vec3f {
    var before = 0.0;
    for (var k = 0u; k <= DRY_STEPS; k++) {
        let share = f32(k) / f32(DRY_STEPS);
        let t = reach * share * share;
        let q = p + t * direction;
        let pixel = pixel_from_eye(q);
        if q.z > -camera.near || !on_screen(pixel) {
            break;
        }
        let z = dry_z_at(pixel);
        if z != 0.0 && q.z <= z {
            var ends = vec2f(before, t);
            for (var half = 0; half < 8; half++) {
                let middle = 0.5 * (ends.x + ends.y);
                let m = p + middle * direction;
                let z_middle = dry_z_at(pixel_from_eye(m));
                ends = select(vec2f(middle, ends.y), vec2f(ends.x, middle), z_middle != 0.0 && m.z <= z_middle);
            }
            let hit = p + ends.y * direction;
            let at = pixel_from_eye(hit);
            // A ray that passes far behind something has not met it.
            if dry_z_at(at) - hit.z <= 0.25 * (t - before) + 0.01 * reach {
                return dry_over_sky(at, direction);
            }
        }
        before = t;
    }
    return sky_towards(direction);
}
