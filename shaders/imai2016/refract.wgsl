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

const BOUNCE_STEPS = 16u;

/// Where a ray is, on a surface of the body or of the splashes.
struct Place {
    found: bool,
    t: f32,
    pixel: vec2f,
    in_body: bool,
    // Outward, in eye space.
    normal: vec3f,
}

var<uniform> params: Params;
var body_z: texture_2d_array<f32>;
var smooth_normal: texture_2d_array<f32>;
var splash_z: texture_2d_array<f32>;
var splash_normal: texture_2d_array<f32>;

@fragment
fn liquid(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = position.xy;
    let texel = vec2i(pixel);
    let first = first_surface(pixel);
    let dry = textureLoad(dry_z, texel, 0).x;
    if !first.found || (dry != 0.0 && dry > -first.t) {
        return textureLoad(dry_color, texel, 0);
    }
    let ray = eye_ray(pixel);
    let p = ray.origin + first.t * ray.direction;
    return vec4f(seen_through(p, normalize(ray.direction), first), 1.0);
}

/// The nearer front of both classes on a view ray; t is -z.
fn first_surface(pixel: vec2f) -> Place {
    let texel = vec2i(pixel);
    let body = textureLoad(body_z, texel, 0, 0).x;
    let splash = textureLoad(splash_z, texel, 0, 0).x;
    if body == 0.0 && splash == 0.0 {
        return Place();
    }
    let in_body = body != 0.0 && (splash == 0.0 || body >= splash);
    return Place(true, -select(splash, body, in_body), pixel, in_body, normal_at(in_body, 0, pixel));
}

fn normal_at(in_body: bool, layer: i32, pixel: vec2f) -> vec3f {
    if in_body {
        return layer_normal(smooth_normal, linear_clamp, layer, pixel);
    }
    return layer_normal(splash_normal, linear_clamp, layer, pixel);
}

/// Equations 6 to 8 as a loop over pairs of surfaces, from where the view ray meets the liquid.
fn seen_through(start: vec3f, view: vec3f, first: Place) -> vec3f {
    var p = start;
    var direction = view;
    var at = first;
    var light = vec3f(0.0);
    var share = vec3f(1.0);
    for (var entered = 1u; entered <= params.refractions; entered += 2u) {
        let outside = facing(at.normal, direction);
        let into = bend_in(direction, outside, params.ior);
        light += share * into.reflectance * background(p, reflect(direction, outside), params.reach_m);
        share *= 1.0 - into.reflectance;
        direction = into.direction;

        at = way_out(p, direction, at);
        p += at.t * direction;
        share *= transmitted(params.absorption, at.t);
        if entered == params.refractions {
            break;
        }
        // Liquid that rests on something wets it: no air between, no second surface.
        let wet = smoothstep(params.contact_m, 0.5 * params.contact_m, dry_distance(p, at.pixel));
        if wet > 0.0 {
            light += share * wet * dry_over_sky(at.pixel, direction);
            share *= 1.0 - wet;
        }
        if wet == 1.0 {
            return light;
        }
        let inside = facing(at.normal, direction);
        let out = bend_out(direction, inside, params.ior);
        if out.reflectance == 1.0 {
            return light + share * thrown_back(p, out.direction, at.in_body);
        }
        light += share * out.reflectance * background(p, reflect(direction, inside), params.reach_m);
        share *= 1.0 - out.reflectance;
        direction = out.direction;

        if entered + 2u > params.refractions {
            break;
        }
        let next = way_in(p, direction);
        if !next.found {
            break;
        }
        at = next;
        p += at.t * direction;
    }
    return light + share * background(p, direction, params.reach_m);
}

/// Total reflection, which the paper leaves open: the ray goes on inside until it meets something dry or leaves the
/// layer between front and back, and then straight on into the air.
fn thrown_back(p: vec3f, direction: vec3f, in_body: bool) -> vec3f {
    var t = 0.0;
    for (var k = 1u; k <= BOUNCE_STEPS; k++) {
        let share = f32(k) / f32(BOUNCE_STEPS);
        let next = params.reach_m * share * share;
        let q = p + next * direction;
        let pixel = pixel_from_eye(q);
        if q.z > -camera.near || !on_screen(pixel) {
            break;
        }
        let texel = vec2i(pixel);
        var ends = vec2f(textureLoad(splash_z, texel, 1, 0).x, textureLoad(splash_z, texel, 0, 0).x);
        if in_body {
            ends = vec2f(textureLoad(body_z, texel, 1, 0).x, textureLoad(body_z, texel, 0, 0).x);
        }
        // A little room behind the back, where the ray starts.
        if ends.y == 0.0 || q.z > ends.y || q.z < ends.x - params.contact_m {
            break;
        }
        t = next;
    }
    return transmitted(params.absorption, t) * background(p + t * direction, direction, params.reach_m);
}

/// From a point on the liquid's surface to the back of the same class.
fn way_out(p: vec3f, direction: vec3f, from_place: Place) -> Place {
    if from_place.in_body {
        let back = leave_shell(body_z, p, direction, params.reach_m, params.secant_steps);
        return Place(true, back.t, back.pixel, true, normal_at(true, 1, back.pixel));
    }
    let back = leave_sphere(splash_z, p, direction, from_place.normal, params.shapes_splash_radius, params.secant_steps);
    if back.found {
        return Place(true, back.t, back.pixel, false, normal_at(false, 1, back.pixel));
    }
    let normal = normalize(params.shapes_splash_radius * from_place.normal + back.t * direction);
    return Place(true, back.t, back.pixel, false, normal);
}

/// The next front that a ray in the air meets, of either class.
fn way_in(p: vec3f, direction: vec3f) -> Place {
    let body = enter_shell(body_z, p, direction, params.reach_m, params.march_steps, params.secant_steps);
    let splash = enter_shell(splash_z, p, direction, params.reach_m, params.march_steps, params.secant_steps);
    if !body.found && !splash.found {
        return Place();
    }
    let in_body = body.found && (!splash.found || body.t <= splash.t);
    if in_body {
        return Place(true, body.t, body.pixel, true, normal_at(true, 0, body.pixel));
    }
    return Place(true, splash.t, splash.pixel, false, normal_at(false, 0, splash.pixel));
}
