// Front and back of both classes in one texture, so that a search reads all four with one load.

var body_z: texture_2d_array<f32>;
var splash_z: texture_2d_array<f32>;

/// Body's front and back, splashes' front and back; eye z, 0 where nothing is.
@fragment
fn join(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    return vec4f(
        textureLoad(body_z, texel, 0, 0).x,
        textureLoad(body_z, texel, 1, 0).x,
        textureLoad(splash_z, texel, 0, 0).x,
        textureLoad(splash_z, texel, 1, 0).x,
    );
}
