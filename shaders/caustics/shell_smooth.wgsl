// One step of smoothing what the light sees of ellipsoids: the mean of normals and paths over a window, without what lies
// more than epsilon before or behind. It stands for the plane fitting that the camera's view gets (Imai 2016, section 4.3).

struct Params {
    epsilon: f32,
    window: i32,
}

var<uniform> params: Params;
var surface: texture_2d<f32>;
var surface_next: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn smooth_step(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2i(textureDimensions(surface));
    let texel = vec2i(id.xy);
    if any(texel >= size) {
        return;
    }
    let own = textureLoad(surface, texel, 0);
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var y = -params.window; y <= params.window; y++) {
        for (var x = -params.window; x <= params.window; x++) {
            let other = textureLoad(surface, clamp(texel + vec2i(x, y), vec2i(0), size - 1), 0);
            let away = vec2f(vec2i(x, y)) / (f32(params.window) + 1.0);
            let apart = (other.w - own.w) / params.epsilon;
            let weight = exp(-2.0 * dot(away, away)) * max(1.0 - apart * apart, 0.0) * f32(dot(other.xyz, other.xyz) > 0.0);
            sum += weight * other;
            weights += weight;
        }
    }
    let is_water = dot(own.xyz, own.xyz) > 0.0 && dot(sum.xyz, sum.xyz) > 0.0;
    textureStore(surface_next, texel, select(vec4f(0.0), vec4f(normalize(sum.xyz), sum.w / weights), is_water));
}
