// Presents a picture before the procedural sky.
#import "lib/camera.wgsl"
#import "lib/light.wgsl"
#import "lib/present.wgsl"
#import "lib/sky.wgsl"

var<uniform> sun: Light;
var picture: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn over_sky(@builtin(global_invocation_id) id: vec3u) {
    let texel = vec2i(id.xy);
    if any(texel >= vec2i(textureDimensions(picture))) {
        return;
    }
    let direction = normalize(world_from_eye_vector(eye_ray(vec2f(texel) + 0.5).direction));
    let to_sun = -sun.direction;
    let backdrop = sky_radiance(direction, to_sun, irradiance(sun), params.brightness)
        + sun_radiance(direction, to_sun, irradiance(sun), params.sun_radius);
    textureStore(picture, texel, presented(textureLoad(color, texel, 0), backdrop));
}
