// Two refractions between the nearest and the farthest surface (Imai 2014, as Imai 2016 section 3.1 describes it).
#import "lib/background.wgsl"
#import "lib/camera.wgsl"
#import "lib/optics.wgsl"
#import "lib/shell_search.wgsl"

struct Params {
    ior: f32,
    absorption: vec3f,
    refractions: u32,
    secant_steps: u32,
    reach_m: f32,
    contact_m: f32,
}

var<uniform> params: Params;
var shell_z: texture_2d_array<f32>;
var smooth_normal: texture_2d_array<f32>;

@fragment
fn liquid(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = position.xy;
    let texel = vec2i(pixel);
    let z = textureLoad(shell_z, texel, 0, 0).x;
    let dry = textureLoad(dry_z, texel, 0).x;
    if z == 0.0 || (dry != 0.0 && dry > z) {
        return textureLoad(dry_color, texel, 0);
    }
    let view = normalize(eye_ray(pixel).direction);
    return vec4f(seen_through(eye_from_pixel(pixel, z), view, pixel), 1.0);
}

fn seen_through(start: vec3f, view: vec3f, pixel: vec2f) -> vec3f {
    let outside = facing(layer_normal(smooth_normal, linear_clamp, 0, pixel), view);
    let into = bend_in(view, outside, params.ior);
    var light = into.reflectance * background(start, reflect(view, outside), params.reach_m);
    let back = leave_shell(shell_z, start, into.direction, params.reach_m, params.secant_steps);
    let p = start + back.t * into.direction;
    var share = (1.0 - into.reflectance) * transmitted(params.absorption, back.t);
    if params.refractions == 1u {
        return light + share * background(p, into.direction, params.reach_m);
    }
    // Liquid that rests on something wets it: no air between, no second surface.
    let wet = smoothstep(params.contact_m, 0.5 * params.contact_m, dry_distance(p, back.pixel));
    if wet > 0.0 {
        light += share * wet * dry_over_sky(back.pixel, into.direction);
        share *= 1.0 - wet;
    }
    let inside = facing(layer_normal(smooth_normal, linear_clamp, 1, back.pixel), into.direction);
    let out = bend_out(into.direction, inside, params.ior);
    light += share * out.reflectance * background(p, reflect(into.direction, inside), params.reach_m);
    if out.reflectance < 1.0 {
        light += share * (1.0 - out.reflectance) * background(p, out.direction, params.reach_m);
    }
    return light;
}
