// The surface of the pool: height and upward speed of each cell. Beyond the walls lies what lies before them.

var surface: texture_2d<f32>;

fn height(texel: vec2i, last: vec2i) -> f32 {
    return textureLoad(surface, clamp(texel, vec2i(0), last), 0).x;
}
