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

var<uniform> params: Params;
var body_z: texture_2d_array<f32>;
var body_normal: texture_2d_array<f32>;
var z_next: texture_storage_2d_array<r32float, write>;

/// What a workgroup's windows cover: the particles' normals, and eye z in w (0: nothing).
var<workgroup> around: array<vec4f, span * span>;

@compute @workgroup_size(8, 8)
fn fit_plane(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let size = vec2i(textureDimensions(body_z));
    let layer = id.z;
    let corner = vec2i(group.xy * TILE) - i32(margin);
    for (var k = lane; k < span * span; k += TILE * TILE) {
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
    let texel = vec2i(id.xy);
    if all(texel < size) {
        var z = around[(local.y + margin) * span + local.x + margin].w;
        if z != 0.0 {
            z = fitted_z(texel, local.xy, z);
        }
        textureStore(z_next, texel, layer, vec4f(z));
    }
}

fn fitted_z(texel: vec2i, local: vec2u, z: f32) -> f32 {
    let pixel = vec2f(texel) + 0.5;
    let ray = eye_ray(pixel);
    // Rays change evenly from pixel to pixel.
    let next = eye_ray(pixel + 1.0);
    let d_origin = next.origin - ray.origin;
    let d_direction = next.direction - ray.direction;
    let p = ray.origin - z * ray.direction;
    let sharpness = -1.442695 / (params.sigma_m * params.sigma_m);
    var weight = 0.0;
    // The mean is taken from this pixel's own point, where the small differences are.
    var offset = vec3f(0.0);
    var normal = vec3f(0.0);
    for (var y = 0u; y <= 2u * margin; y++) {
        let row = (local.y + y) * span + local.x;
        for (var x = 0u; x <= 2u * margin; x++) {
            let surface = around[row + x];
            let step = vec3f(vec2f(vec2u(x, y)) - f32(margin), 0.0);
            let away = ray.origin + step * d_origin - surface.w * (ray.direction + step * d_direction) - p;
            let squared = select(away.z * away.z, dot(away, away), params.weights == DISTANCE_WEIGHTS);
            // Equation 2, or figure 5's view-independent weights.
            let w = select(exp2(squared * sharpness), 0.0, surface.w == 0.0);
            weight += w;
            offset += w * away;
            normal += w * surface.xyz;
        }
    }
    // Equation 3; opposed normals may cancel.
    let length_2 = dot(normal, normal);
    if length_2 <= 1.0e-12 * weight * weight {
        return z;
    }
    let n = normal * inverseSqrt(length_2);
    // Equations 4 and 5, as the step along this pixel's ray from z: n . (mean - p) = n . direction * (z - z_new).
    let slope = dot(n, ray.direction);
    if abs(slope) < EDGE_ON * length(ray.direction) {
        return z;
    }
    let step = -dot(n, offset / weight) / slope;
    // Not in the paper: a plane that is nearly edge-on must not throw the surface further than the weights reach.
    return min(z + clamp(step, -params.sigma_m, params.sigma_m), -camera.near);
}
