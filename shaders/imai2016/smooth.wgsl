// One step of iterative local plane fitting (Imai 2016, section 4.3, equations 1 to 5), front and back at once.
#import "lib/camera.wgsl"

struct Params {
    weights: u32,
    sigma_m: f32,
}

const DISTANCE_WEIGHTS = 1u;
const TILE = 8u;

/// Below this the plane is seen too much from its edge for a ray to meet it well.
const EDGE_ON = 0.005;

/// Edge of the window in pixels; odd.
override window: u32 = 9u;
override margin: u32 = window / 2u;
override span: u32 = TILE + 2u * margin;
override area: u32 = span * (2u * TILE + 2u * margin);

var<uniform> params: Params;
var body_z: texture_2d_array<f32>;
var body_normal: texture_2d_array<f32>;
var z_next: texture_storage_2d_array<r32float, write>;

/// What a workgroup's windows cover: the particles' normals, and eye z in w (0: nothing).
var<workgroup> around: array<vec4f, area>;

/// A pixel on its surface, and the sums over its window.
struct Fit {
    p: vec3f,
    z: f32,
    weight: f32,
    // The mean is taken from the pixel's own point, where the small differences are.
    offset: vec3f,
    normal: vec3f,
}

/// A thread smooths two pixels, one above the other, whose windows share all rows but two.
@compute @workgroup_size(8, 8)
fn fit_plane(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let size = vec2i(textureDimensions(body_z));
    let layer = id.z;
    let corner = vec2i(group.xy * vec2u(TILE, 2u * TILE)) - i32(margin);
    for (var k = lane; k < area; k += TILE * TILE) {
        let at = corner + vec2i(vec2u(k % span, k / span));
        var value = vec4f(0.0);
        if all(at >= vec2i(0)) && all(at < size) {
            value.w = textureLoad(body_z, at, layer, 0).x;
            if value.w != 0.0 {
                value = vec4f(textureLoad(body_normal, at, layer, 0).xyz, value.w);
            }
        }
        around[k] = value;
    }
    workgroupBarrier();
    let texel = vec2i(id.xy * vec2u(1u, 2u));
    let first = 2u * local.y * span + local.x;
    var upper = start(texel, around[first + margin * span + margin].w);
    var lower = start(texel + vec2i(0, 1), around[first + (margin + 1u) * span + margin].w);
    if upper.z != 0.0 || lower.z != 0.0 {
        let ray = eye_ray(vec2f(texel) + 0.5);
        // Rays change evenly from pixel to pixel.
        let next = eye_ray(vec2f(texel) + 1.5);
        let d_origin = next.origin - ray.origin;
        let d_direction = next.direction - ray.direction;
        for (var y = 0u; y <= 2u * margin + 1u; y++) {
            for (var x = 0u; x <= 2u * margin; x++) {
                let surface = around[first + y * span + x];
                let step = vec3f(vec2f(vec2u(x, y)) - f32(margin), 0.0);
                let p = ray.origin + step * d_origin - surface.w * (ray.direction + step * d_direction);
                if y <= 2u * margin {
                    add(&upper, p, surface);
                }
                if y > 0u {
                    add(&lower, p, surface);
                }
            }
        }
    }
    if all(texel < size) {
        textureStore(z_next, texel, layer, vec4f(fitted_z(upper, texel)));
    }
    if all(texel + vec2i(0, 1) < size) {
        textureStore(z_next, texel + vec2i(0, 1), layer, vec4f(fitted_z(lower, texel + vec2i(0, 1))));
    }
}

fn start(texel: vec2i, z: f32) -> Fit {
    return Fit(eye_from_pixel(vec2f(texel) + 0.5, z), z, 0.0, vec3f(0.0), vec3f(0.0));
}

fn add(fit: ptr<function, Fit>, p: vec3f, surface: vec4f) {
    let away = p - (*fit).p;
    let squared = select(away.z * away.z, dot(away, away), params.weights == DISTANCE_WEIGHTS);
    // Equation 2, or figure 5's view-independent weights.
    let sharpness = -1.442695 / (params.sigma_m * params.sigma_m);
    let w = select(exp2(squared * sharpness), 0.0, surface.w == 0.0);
    (*fit).weight += w;
    (*fit).offset += w * away;
    (*fit).normal += w * surface.xyz;
}

fn fitted_z(fit: Fit, texel: vec2i) -> f32 {
    // Equation 3; opposed normals may cancel.
    let length_2 = dot(fit.normal, fit.normal);
    if fit.z == 0.0 || length_2 <= 1.0e-12 * fit.weight * fit.weight {
        return fit.z;
    }
    let n = fit.normal * inverseSqrt(length_2);
    // Equations 4 and 5, as the step along this pixel's ray from z: n . (mean - p) = n . direction * (z - z_new).
    let direction = eye_ray(vec2f(texel) + 0.5).direction;
    let slope = dot(n, direction);
    if abs(slope) < EDGE_ON * length(direction) {
        return fit.z;
    }
    let step = -dot(n, fit.offset / fit.weight) / slope;
    // Not in the paper: a plane that is nearly edge-on must not throw the surface further than the weights reach.
    return min(fit.z + clamp(step, -params.sigma_m, params.sigma_m), -camera.near);
}
