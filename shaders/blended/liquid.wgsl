// Which fragments of what blends lie before the liquid's back, what of them the opaque scene leaves, and what the liquid
// before them takes of their light.
#import "lib/camera.wgsl"

struct Liquid {
    absorption: vec3f,
}

struct Shown {
    @location(0) color: vec4f,
    // Samples before the opaque scene.
    @builtin(sample_mask) samples: u32,
}

/// Those that are wanted: what lies before the back, or what lies behind it.
override before: bool = true;

var<uniform> liquid: Liquid;
// Of the opaque scene, reversed.
var depth_ms: texture_depth_multisampled_2d;
// Eye z of front and back of the liquid's body, and of its splashes; 0 is nothing.
var layers: texture_2d<f32>;

/// A fragment's premultiplied colour, where it is wanted. Beside the liquid it always is: what is seen there directly lies
/// over the picture, and rays that come from elsewhere look it up. Within the liquid it is laid over too, where it stands,
/// not where it would be seen refracted: so the liquid behind it shows.
fn in_liquid(color: vec4f, position: vec4f) -> Shown {
    let texel = vec2i(position.xy);
    var samples = 0u;
    for (var k = 0u; k < 4u; k++) {
        samples |= select(0u, 1u << k, position.z > textureLoad(depth_ms, texel, k));
    }
    let z = textureLoad(layers, texel, 0);
    if z.x == 0.0 && z.z == 0.0 {
        return Shown(color, samples);
    }
    let front = max(select(z.x, z.z, z.x == 0.0), select(z.z, z.x, z.z == 0.0));
    let back = min(select(z.y, z.w, z.x == 0.0), select(z.w, z.y, z.z == 0.0));
    let here = eye_z_from_depth(position.z);
    if before != (here >= back) {
        discard;
    }
    // Between body and splashes too, for simplicity.
    let path_m = max(front - here, 0.0) * length(eye_ray(position.xy).direction);
    return Shown(vec4f(color.rgb * select(vec3f(1.0), exp(-liquid.absorption * path_m), before), color.a), samples);
}
