// What lies over the picture: premultiplied.

var over: texture_2d<f32>;

@fragment
fn lay(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return textureLoad(over, vec2i(position.xy), 0);
}
