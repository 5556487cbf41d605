// Presents a picture before an equirectangular environment.
#import "lib/camera.wgsl"
#import "lib/equirect.wgsl"
#import "lib/present.wgsl"

var environment: texture_2d<f32>;
var linear_repeat: sampler;

@fragment
fn over_picture(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let direction = normalize(world_from_eye_vector(eye_ray(position.xy).direction));
    let margin = 0.5 / f32(textureDimensions(environment).y);
    let uv = equirect_uv(direction);
    let at = vec2f(uv.x, clamp(uv.y, margin, 1.0 - margin));
    let backdrop = params.brightness * textureSampleLevel(environment, linear_repeat, at, 0.0).rgb;
    return presented(textureLoad(color, vec2i(position.xy), 0), backdrop);
}
