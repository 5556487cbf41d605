// Explicit diffusion: each texel moves towards the mean of its four neighbours. Step 0 puts a hot disc in the middle.
struct Now {
    step: u32,
}

var<uniform> now: Now;
var heat: texture_2d<f32>;
var heat_next: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn spread(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(heat);
    if any(id.xy >= size) {
        return;
    }
    let at = vec2i(id.xy);
    if now.step == 0u {
        let from_middle = 2.0 * (vec2f(id.xy) + 0.5) / vec2f(size) - 1.0;
        textureStore(heat_next, at, vec4f(select(0.0, 1.0, length(from_middle) < 0.25)));
        return;
    }
    let last = vec2i(size) - 1;
    let around = textureLoad(heat, max(at - vec2i(1, 0), vec2i(0)), 0).x
        + textureLoad(heat, max(at - vec2i(0, 1), vec2i(0)), 0).x
        + textureLoad(heat, min(at + vec2i(1, 0), last), 0).x
        + textureLoad(heat, min(at + vec2i(0, 1), last), 0).x;
    let here = textureLoad(heat, at, 0).x;
    textureStore(heat_next, at, vec4f(mix(here, 0.25 * around, 0.9)));
}
