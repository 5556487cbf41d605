// Shows a texture.
var source: texture_2d<f32>;

@fragment
fn main(@builtin(position) at: vec4f) -> @location(0) vec4f {
    return textureLoad(source, vec2i(at.xy), 0);
}
