// Presents a picture before an equirectangular environment.
#import "lib/camera.wgsl"
#import "lib/equirect.wgsl"
#import "lib/present.wgsl"

var environment: texture_2d<f32>;
var linear_repeat: sampler;
var picture: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn over_picture(@builtin(global_invocation_id) id: vec3u) {
    let texel = vec2i(id.xy);
    if any(texel >= vec2i(textureDimensions(picture))) {
        return;
    }
    let direction = normalize(world_from_eye_vector(eye_ray(vec2f(texel) + 0.5).direction));
    let margin = 0.5 / f32(textureDimensions(environment).y);
    let uv = equirect_uv(direction);
    let at = vec2f(uv.x, clamp(uv.y, margin, 1.0 - margin));
    let backdrop = params.brightness * textureSampleLevel(environment, linear_repeat, at, 0.0).rgb;
    textureStore(picture, texel, presented(textureLoad(color, texel, 0), backdrop));
}
