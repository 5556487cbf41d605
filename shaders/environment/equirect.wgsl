// An equirectangular picture into the six faces of a cube, several samples a texel.
#import "lib/cube.wgsl"
#import "lib/equirect.wgsl"

struct Params {
    samples: u32,
    brightness: f32,
}

var<uniform> params: Params;
var environment: texture_2d<f32>;
var linear_repeat: sampler;
var cube: texture_storage_2d_array<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn project(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(cube);
    if any(id.xy >= size) {
        return;
    }
    // Half a texel away from the poles, where the repeating sampler would mix them.
    let margin = 0.5 / f32(textureDimensions(environment).y);
    var sum = vec3f(0.0);
    for (var k = 0u; k < params.samples * params.samples; k++) {
        let part = (vec2f(vec2u(k % params.samples, k / params.samples)) + 0.5) / f32(params.samples);
        let uv = equirect_uv(normalize(cube_direction(id.z, (vec2f(id.xy) + part) / vec2f(size))));
        let at = vec2f(uv.x, clamp(uv.y, margin, 1.0 - margin));
        sum += textureSampleLevel(environment, linear_repeat, at, 0.0).rgb;
    }
    // Half floats end at 65,504.
    let color = min(params.brightness * sum / f32(params.samples * params.samples), vec3f(60000.0));
    textureStore(cube, id.xy, id.z, vec4f(color, 1.0));
}
