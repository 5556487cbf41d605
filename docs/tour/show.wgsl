// Heat as a glow that covers what is behind it.
var heat: texture_2d<f32>;

@fragment
fn show(@location(0) uv: vec2f) -> @location(0) vec4f {
    let size = textureDimensions(heat);
    let t = clamp(textureLoad(heat, min(vec2u(uv * vec2f(size)), size - 1u), 0).x, 0.0, 1.0);
    return vec4f(t, t * t, 0.3 * t * t * t, t);
}
