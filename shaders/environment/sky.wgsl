// The procedural sky with its sun into the six faces of a cube.
#import "lib/cube.wgsl"
#import "lib/light.wgsl"
#import "lib/sky.wgsl"

struct Params {
    brightness: f32,
    sun_radius: f32,
}

var<uniform> params: Params;
var<uniform> sun: Light;
var cube: texture_storage_2d_array<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn draw_sky(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(cube);
    if any(id.xy >= size) {
        return;
    }
    let direction = normalize(cube_direction(id.z, (vec2f(id.xy) + 0.5) / vec2f(size)));
    let to_sun = -sun.direction;
    let color = sky_radiance(direction, to_sun, irradiance(sun), params.brightness)
        + sun_radiance(direction, to_sun, irradiance(sun), params.sun_radius);
    textureStore(cube, id.xy, id.z, vec4f(color, 1.0));
}
