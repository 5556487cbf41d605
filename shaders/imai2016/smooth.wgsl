// One step of iterative local plane fitting (Imai 2016, section 4.3, equations 1 to 5), front and back at once.
#import "lib/camera.wgsl"

struct Params {
    window: u32,
    weights: u32,
    sigma_m: f32,
}

const DISTANCE_WEIGHTS = 1u;

/// Below this the plane is seen too much from its edge for a ray to meet it well.
const EDGE_ON = 0.005;

var<uniform> params: Params;
var body_z: texture_2d_array<f32>;
var body_normal: texture_2d_array<f32>;
var z_next: texture_storage_2d_array<r32float, write>;

@compute @workgroup_size(8, 8)
fn fit_plane(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2i(textureDimensions(body_z));
    let texel = vec2i(id.xy);
    let layer = id.z;
    if any(texel >= size) {
        return;
    }
    let z = textureLoad(body_z, texel, layer, 0).x;
    var smoothed = z;
    if z != 0.0 {
        smoothed = fitted_z(texel, layer, z, size);
    }
    textureStore(z_next, texel, layer, vec4f(smoothed));
}

fn fitted_z(texel: vec2i, layer: u32, z: f32, size: vec2i) -> f32 {
    let half_window = i32(params.window) / 2;
    let low = max(texel - half_window, vec2i(0));
    let high = min(texel + half_window, size - 1);
    let p = eye_from_pixel(vec2f(texel) + 0.5, z);
    let inverse = 1.0 / (params.sigma_m * params.sigma_m);
    var weight = 0.0;
    // The mean is taken from this pixel's own point, where the small differences are.
    var offset = vec3f(0.0);
    var normal = vec3f(0.0);
    for (var y = low.y; y <= high.y; y++) {
        for (var x = low.x; x <= high.x; x++) {
            let z_j = textureLoad(body_z, vec2i(x, y), layer, 0).x;
            if z_j == 0.0 {
                continue;
            }
            let away = eye_from_pixel(vec2f(f32(x), f32(y)) + 0.5, z_j) - p;
            let squared = select(away.z * away.z, dot(away, away), params.weights == DISTANCE_WEIGHTS);
            // Equation 2, or figure 5's view-independent weights.
            let w = exp(-squared * inverse);
            weight += w;
            offset += w * away;
            normal += w * textureLoad(body_normal, vec2i(x, y), layer, 0).xyz;
        }
    }
    // Equation 3; opposed normals may cancel.
    let length_2 = dot(normal, normal);
    if length_2 <= 1.0e-12 * weight * weight {
        return z;
    }
    let n = normal * inverseSqrt(length_2);
    // Equations 4 and 5, as the step along this pixel's ray from z: n . (mean - p) = n . direction * (z - z_new).
    let direction = eye_ray(vec2f(texel) + 0.5).direction;
    let slope = dot(n, direction);
    if abs(slope) < EDGE_ON * length(direction) {
        return z;
    }
    let step = -dot(n, offset / weight) / slope;
    // Not in the paper: a plane that is nearly edge-on must not throw the surface further than the weights reach.
    return min(z + clamp(step, -params.sigma_m, params.sigma_m), -camera.near);
}
