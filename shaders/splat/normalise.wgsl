// Third pass: sums divided by the sum of their weights (Iwasaki et al. 2006, section 5.3).

struct Surface {
    @location(0) z: f32,
    @location(1) normal: vec4f,
}

var normal_sum: texture_2d<f32>;
var z_sum: texture_2d<f32>;

@fragment
fn divide(@builtin(position) position: vec4f) -> Surface {
    let texel = vec2i(position.xy);
    let sum = textureLoad(normal_sum, texel, 0);
    let length_2 = dot(sum.xyz, sum.xyz);
    if sum.w == 0.0 || length_2 == 0.0 {
        return Surface(0.0, vec4f(0.0));
    }
    return Surface(textureLoad(z_sum, texel, 0).x / sum.w, vec4f(sum.xyz * inverseSqrt(length_2), 0.0));
}
