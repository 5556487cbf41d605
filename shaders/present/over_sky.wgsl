// Presents a picture before the procedural sky.
#import "lib/camera.wgsl"
#import "lib/light.wgsl"
#import "lib/present.wgsl"
#import "lib/sky.wgsl"

var<uniform> sun: Light;

@fragment
fn over_sky(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let direction = normalize(world_from_eye_vector(eye_ray(position.xy).direction));
    let to_sun = -sun.direction;
    let backdrop = sky_radiance(direction, to_sun, irradiance(sun), params.brightness)
        + sun_radiance(direction, to_sun, irradiance(sun), params.sun_radius);
    return presented(textureLoad(color, vec2i(position.xy), 0), backdrop);
}
