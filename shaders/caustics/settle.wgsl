// A sample plane from its sum, by a Gaussian filter if one is asked for.

struct Params {
    blur: i32,
}

var<uniform> params: Params;
var plane_sum: texture_2d<f32>;

@fragment
fn filtered(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let size = vec2i(textureDimensions(plane_sum));
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var y = -params.blur; y <= params.blur; y++) {
        for (var x = -params.blur; x <= params.blur; x++) {
            let away = vec2f(vec2i(x, y)) / (f32(params.blur) + 1.0);
            let weight = exp(-2.0 * dot(away, away));
            sum += weight * textureLoad(plane_sum, clamp(texel + vec2i(x, y), vec2i(0), size - 1), 0).rgb;
            weights += weight;
        }
    }
    // Half floats end at 65,504.
    return vec4f(min(sum / weights, vec3f(60000.0)), 1.0);
}
