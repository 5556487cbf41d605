// What is left of white light behind the balls (the Beer-Lambert law); thin places are see-through.
struct Params {
    absorption: vec3f,
}

var<uniform> params: Params;
var thickness: texture_2d<f32>;

@fragment
fn shade(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let metres = textureLoad(thickness, vec2i(at.xy), 0).x;
    let coverage = 1.0 - exp(-20.0 * metres);
    return vec4f(exp(-params.absorption * metres), 1.0) * coverage;
}
