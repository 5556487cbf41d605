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
    march_steps: u32,
    reach_m: f32,
    contact_m: f32,
}

var<uniform> params: Params;
// Front and back of all particles.
var layers: texture_2d<f32>;
var smooth_normal: texture_2d_array<f32>;
// The dry scene without what blends, as it is seen directly: that is laid over the picture.
var opaque_color: texture_2d<f32>;
var opaque_z: texture_2d<f32>;
var raw: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn liquid(@builtin(global_invocation_id) id: vec3u) {
    let texel = vec2i(id.xy);
    if all(texel < vec2i(textureDimensions(raw))) {
        textureStore(raw, texel, seen(texel));
    }
}

/// Premultiplied colour of a pixel: the dry scene where it hides the liquid or there is none.
fn seen(texel: vec2i) -> vec4f {
    let pixel = vec2f(texel) + 0.5;
    let z = textureLoad(layers, texel, 0).x;
    let dry = textureLoad(opaque_z, texel, 0).x;
    if z == 0.0 || (dry != 0.0 && dry > z) {
        return textureLoad(opaque_color, texel, 0);
    }
    let view = normalize(eye_ray(pixel).direction);
    return vec4f(seen_through(eye_from_pixel(pixel, z), view, pixel), 1.0);
}

fn seen_through(start: vec3f, view: vec3f, pixel: vec2f) -> vec3f {
    let outside = facing(layer_normal(smooth_normal, linear_clamp, 0, pixel), view);
    let into = bend_in(view, outside, params.ior);
    var rays: Rays;
    add_ray(&rays, start, reflect(view, outside), vec3f(into.reflectance));
    let back = leave_shell(layers, BODY, start, into.direction, params.reach_m, params.secant_steps);
    let within = stands_within(start, into.direction, back.t, params.march_steps);
    let length = select(back.t, within.before, within.found);
    let p = start + length * into.direction;
    var direction = into.direction;
    var share = (1.0 - into.reflectance) * transmitted(params.absorption, length);
    if params.refractions > 1u && !within.found {
        let wet = wetting(p, back.pixel, params.contact_m);
        add_ray(&rays, p, direction, share * wet);
        share *= 1.0 - wet;
        let inside = facing(layer_normal(smooth_normal, linear_clamp, 1, back.pixel), direction);
        let out = bend_out(direction, inside, params.ior);
        add_ray(&rays, p, reflect(direction, inside), share * out.reflectance);
        direction = out.direction;
        share *= 1.0 - out.reflectance;
    }
    add_ray(&rays, p, direction, share);
    return gathered(&rays, params.reach_m, params.march_steps);
}
