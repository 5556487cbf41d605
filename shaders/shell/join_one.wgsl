// Front and back of one shell in one texture, so that a search reads both with one load.

var shell_z: texture_2d_array<f32>;

/// Front and back; eye z, 0 where nothing is.
@fragment
fn join(@builtin(position) position: vec4f) -> @location(0) vec2f {
    let texel = vec2i(position.xy);
    return vec2f(textureLoad(shell_z, texel, 0, 0).x, textureLoad(shell_z, texel, 1, 0).x);
}
