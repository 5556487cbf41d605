// One step of smoothing.
var source: texture_2d<f32>;
var canvas: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    textureStore(canvas, vec2i(id.xy), textureLoad(source, vec2i(id.xy), 0));
}
