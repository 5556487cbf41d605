// The picture over its backdrop, exposed, balanced and tone-mapped.
#import "lib/tone.wgsl"
#import "lib/white.wgsl"

struct Params {
    exposure: f32,
    temperature: f32,
    tint: f32,
    brightness: f32,
    sun_radius: f32,
}

// Known when the pipeline is made: drivers that specialise shaders by the uniforms that branches read make them anew at
// every frame.
override tone: u32;
override transparent: u32;

var<uniform> params: Params;
var color: texture_2d<f32>;

/// Tone curves bend only straight colours, so coverage is divided out first and multiplied in again.
fn presented(over: vec4f, backdrop: vec3f) -> vec4f {
    let gain = exp2(params.exposure);
    if transparent != 0u {
        let straight = over.rgb / max(over.a, 1.0e-4);
        return vec4f(shown(gain * straight) * over.a, over.a);
    }
    return vec4f(shown(gain * (over.rgb + (1.0 - over.a) * backdrop)), 1.0);
}

fn shown(color: vec3f) -> vec3f {
    return tone_mapped(white_balanced(color, params.temperature, params.tint), tone);
}
