// The blended droplets as a premultiplied colour.

var light: texture_2d<f32>;
var clear: texture_2d<f32>;

@fragment
fn over(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let sum = textureLoad(light, texel, 0);
    let alpha = 1.0 - textureLoad(clear, texel, 0).x;
    return vec4f(sum.rgb / max(sum.a, 1.0e-6), 1.0) * alpha;
}
