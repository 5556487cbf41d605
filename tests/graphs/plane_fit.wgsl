// A tilted plane as a depth map, with noise, a step or an edge in the picture's middle, and its exact normals.
#import "lib/camera.wgsl"

struct Params {
    distance: f32,
    tilt: f32,
    noise_m: f32,
    step_m: f32,
    cut: u32,
}

var<uniform> params: Params;
var truth: texture_storage_2d_array<r32float, write>;
var normal: texture_storage_2d_array<rgba16float, write>;
var fitted: texture_storage_2d_array<r32float, write>;
var filtered: texture_storage_2d_array<r32float, write>;

/// Between -1 and 1, a hash of the pixel and the layer.
fn noise(at: vec3u) -> f32 {
    var state = at.x * 1664525u + at.y * 22695477u + at.z * 747796405u + 2891336453u;
    state = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    state = (state >> 22u) ^ state;
    return f32(state) / 2147483648.0 - 1.0;
}

@compute @workgroup_size(8, 8)
fn make(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(truth);
    if any(id.xy >= size) {
        return;
    }
    let right = id.x * 2u >= size.x;
    let angle = radians(params.tilt);
    // The plane's right side lies farther away.
    let n = vec3f(sin(angle), 0.0, cos(angle));
    let through = vec3f(0.0, 0.0, -params.distance - select(0.0, params.step_m, right));
    let direction = eye_ray(vec2f(id.xy) + 0.5).direction;
    var z = -dot(n, through) / dot(n, direction);
    // Rays that miss the plane in front of the eye see nothing.
    if !(z < -camera.near) || (right && params.cut != 0u) {
        z = 0.0;
    }
    var noisy = z;
    if z != 0.0 {
        noisy = min(z + params.noise_m * noise(id), -camera.near);
    }
    textureStore(truth, id.xy, id.z, vec4f(z));
    textureStore(fitted, id.xy, id.z, vec4f(noisy));
    textureStore(filtered, id.xy, id.z, vec4f(noisy));
    textureStore(normal, id.xy, id.z, vec4f(select(n, -n, id.z == 1u), 0.0));
}
