// Equation 3 (Iwasaki et al. 2006): the sums divided by the sum of weights. Unit normal, and metres of light from the
// screen to the surface; a normal of 0 where the light meets no water.

var sum: texture_2d<f32>;
var depth_sum: texture_2d<f32>;

@fragment
fn divide(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let normals = textureLoad(sum, texel, 0);
    let length_2 = dot(normals.xyz, normals.xyz);
    if normals.w == 0.0 || length_2 == 0.0 {
        return vec4f(0.0);
    }
    return vec4f(normals.xyz * inverseSqrt(length_2), textureLoad(depth_sum, texel, 0).x / normals.w);
}
