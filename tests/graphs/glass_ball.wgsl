// Two refractions of one sphere with the library's functions: eye-space direction that leaves it, path length in w.
#import "lib/camera.wgsl"
#import "lib/optics.wgsl"
#import "lib/shell_search.wgsl"

struct Params {
    ior: f32,
    secant_steps: u32,
    shapes_splash_radius: f32,
}

var<uniform> params: Params;
var layers: texture_2d<f32>;
var splash_normal: texture_2d_array<f32>;
var linear_clamp: sampler;

@fragment
fn leaving(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = position.xy;
    let z = textureLoad(layers, vec2i(pixel), 0).z;
    if z == 0.0 {
        return vec4f(0.0);
    }
    let p = eye_from_pixel(pixel, z);
    let view = normalize(eye_ray(pixel).direction);
    let outside = facing(layer_normal(splash_normal, linear_clamp, 0, pixel), view);
    let direction = bend_in(view, outside, params.ior).direction;
    let reach = SPHERE_REACH * params.shapes_splash_radius;
    let found = leave_shell(layers, SPLASH, p, direction, reach, params.secant_steps);
    let back = leave_sphere(found, p, direction, outside, params.shapes_splash_radius);
    let inside = facing(layer_normal(splash_normal, linear_clamp, 1, back.pixel), direction);
    return vec4f(bend_out(direction, inside, params.ior).direction, back.t);
}
