// Up to four refractions through splashes and body, in whatever order the ray meets them, with absorption along the
// way (Imai 2016, sections 4.4 and 4.5, equations 6 to 9).
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
    shapes_splash_radius: f32,
}

var<uniform> params: Params;
// Front and back of the body, front and back of the splashes.
var layers: texture_2d<f32>;
var smooth_normal: texture_2d_array<f32>;
// The dry scene without what blends, as it is seen directly: that is laid over the picture.
var opaque_color: texture_2d<f32>;
var opaque_z: texture_2d<f32>;
var raw: texture_storage_2d<rgba16float, write>;
var splash_normal: texture_2d_array<f32>;

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
    let z = textureLoad(layers, texel, 0);
    // The nearer of the fronts; 0 is nothing.
    let in_body = z.x != 0.0 && (z.z == 0.0 || z.x >= z.z);
    let front = select(z.z, z.x, in_body);
    let dry = textureLoad(opaque_z, texel, 0).x;
    if front == 0.0 || (dry != 0.0 && dry > front) {
        return textureLoad(opaque_color, texel, 0);
    }
    let first = Crossing(true, select(SPLASH, BODY, in_body), 0.0, pixel);
    return vec4f(seen_through(eye_from_pixel(pixel, front), normalize(eye_ray(pixel).direction), first), 1.0);
}

/// Equations 6 to 8 as a loop over pairs of surfaces, from where the view ray meets the liquid.
fn seen_through(start: vec3f, view: vec3f, first: Crossing) -> vec3f {
    var p = start;
    var direction = view;
    var at = first;
    var share = vec3f(1.0);
    var rays: Rays;
    for (var entered = 1u; entered <= params.refractions; entered += 2u) {
        let normal = normal_at(at.shell, 0, at.pixel);
        let outside = facing(normal, direction);
        let into = bend_in(direction, outside, params.ior);
        add_ray(&rays, p, reflect(direction, outside), share * into.reflectance);
        direction = into.direction;

        let in_body = at.shell == BODY;
        let reach = select(SPHERE_REACH * params.shapes_splash_radius, params.reach_m, in_body);
        at = leave_shell(layers, at.shell, p, direction, reach, params.secant_steps);
        if !in_body {
            at = leave_sphere(at, p, direction, normal, params.shapes_splash_radius);
        }
        share *= 1.0 - into.reflectance;
        let within = stands_within(p, direction, at.t, params.march_steps);
        if within.found {
            p += within.before * direction;
            share *= transmitted(params.absorption, within.before);
            break;
        }
        p += at.t * direction;
        share *= transmitted(params.absorption, at.t);
        if entered == params.refractions {
            break;
        }
        // Splashes fly or bounce: only the body wets what it lies on.
        let wet = wetting(p, at.pixel, select(0.0, params.contact_m, in_body));
        add_ray(&rays, p, direction, share * wet);
        share *= 1.0 - wet;
        if wet == 1.0 {
            break;
        }
        var back = normal_at(at.shell, 1, at.pixel);
        if !in_body && !at.found {
            back = normalize(params.shapes_splash_radius * normal + at.t * direction);
        }
        let inside = facing(back, direction);
        let out = bend_out(direction, inside, params.ior);
        if out.reflectance == 1.0 {
            let t = thrown_back(p, out.direction, at.shell);
            direction = out.direction;
            p += t * direction;
            share *= transmitted(params.absorption, t);
            break;
        }
        add_ray(&rays, p, reflect(direction, inside), share * out.reflectance);
        share *= 1.0 - out.reflectance;
        direction = out.direction;

        if entered + 2u > params.refractions {
            break;
        }
        let next = enter_shells(layers, p, direction, params.reach_m, params.march_steps, params.secant_steps);
        if !next.found {
            break;
        }
        at = next;
        p += at.t * direction;
    }
    add_ray(&rays, p, direction, share);
    return gathered(&rays, params.reach_m, params.march_steps);
}

fn normal_at(shell: u32, layer: i32, pixel: vec2f) -> vec3f {
    if shell == BODY {
        return layer_normal(smooth_normal, linear_clamp, layer, pixel);
    }
    return layer_normal(splash_normal, linear_clamp, layer, pixel);
}

/// Total reflection, which the paper leaves open: how far the ray goes on inside until it leaves the layer between
/// front and back; from there it goes straight on into the air.
fn thrown_back(p: vec3f, direction: vec3f, shell: u32) -> f32 {
    var t = 0.0;
    for (var k = 1u; k <= params.march_steps; k++) {
        let share = f32(k) / f32(params.march_steps);
        let next = params.reach_m * share * share;
        let q = p + next * direction;
        let pixel = pixel_from_eye(q);
        if q.z > -camera.near || !on_screen(pixel) {
            break;
        }
        let z = textureLoad(layers, vec2i(pixel), 0);
        let ends = select(z.zw, z.xy, shell == BODY);
        // A little room behind the back, where the ray starts.
        if ends.x == 0.0 || q.z > ends.x || q.z < ends.y - params.contact_m {
            break;
        }
        t = next;
    }
    return t;
}
