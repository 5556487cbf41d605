// The water's picture: reflection of the environment, refraction into the lit pool, absorption on the way (Iwasaki et
// al. 2006, section 5.3).
#import "lib/camera.wgsl"
#import "lib/optics.wgsl"
#import "lib/pool.wgsl"
#import "lib/slices.wgsl"

/// The box in which particles lie.
struct Box {
    low: vec3f,
    high: vec3f,
}

var<uniform> box_of: Box;
var water_z: texture_2d<f32>;
var water_normal: texture_2d<f32>;
// Where rays leave again.
var back_z: texture_2d<f32>;
var back_normal: texture_2d<f32>;
var dry_color: texture_2d<f32>;
var dry_z: texture_2d<f32>;
var slices: texture_2d_array<f32>;
var slice_heights: texture_2d_array<f32>;
var sky_cube: texture_cube<f32>;
/// 1 where the eye is outside, -1 under water.
var<storage, read> eye: array<f32>;

/// What a ray meets in the sliced object images: light, of which water has taken its part, and what is left of what
/// comes from behind.
struct SliceHit {
    light: vec3f,
    left: f32,
}

/// The meshes that a ray going down meets in the sliced object images: the first, and those that blend before it.
fn slice_hit(p: vec3f, direction: vec3f, reach: f32) -> SliceHit {
    var found = SliceHit(vec3f(0.0), 1.0);
    if direction.y > -0.01 {
        return found;
    }
    let seen_along = slice_view(camera.position);
    let last = plane_stack.planes - 1u;
    let size = textureDimensions(slices).xy;
    let spacing = (light_screen.top_m - light_screen.bottom_m) / f32(last);
    let start = clamp((light_screen.top_m - p.y) / spacing, 0.0, f32(last - 1u));
    for (var slice = u32(start); slice < last; slice++) {
        // Across the slice the ray is taken to go along the direction from which the image is seen.
        let upper = light_screen.top_m - spacing * f32(slice);
        let t = (upper - 0.5 * spacing - p.y) / direction.y;
        let uv = slice_uv(p + t * direction, seen_along, upper);
        if any(uv <= vec2f(0.0)) || any(uv >= vec2f(1.0)) {
            continue;
        }
        let texel = vec2u(uv * vec2f(size));
        let color = textureSampleLevel(slices, linear_clamp, uv, slice, 0.0);
        let covers = textureLoad(slices, texel, slice, 0).a;
        let height = textureLoad(slice_heights, texel, slice, 0).x;
        let t_hit = (height - p.y) / direction.y;
        if covers == 0.0 || color.a <= 0.5 * covers || t_hit <= 0.0 || t_hit >= reach {
            continue;
        }
        // Slices overlap: what blends is in two of them there, and counts in its own.
        let is_opaque = covers > 0.999;
        let is_own = (slice == 0u || height < upper) && (slice + 1u == last || height >= upper - spacing);
        if is_opaque || is_own {
            found.light += found.left * covers * color.rgb / color.a * transmitted(plane_stack.absorption, t_hit);
            found.left *= select(1.0 - covers, 0.0, is_opaque);
        }
        if is_opaque {
            break;
        }
    }
    return found;
}

/// Metres that a ray goes in the box where the water is.
fn in_box_m(p: vec3f, direction: vec3f) -> f32 {
    let towards = select(box_of.low, box_of.high, direction > vec3f(0.0));
    let t = (towards - p) / select(direction, vec3f(1.0e-6), abs(direction) < vec3f(1.0e-6));
    return max(min(t.x, min(t.y, t.z)), 0.0);
}

/// Where a ray leaves again what it has entered: metres, and the outward normal; 0 where it does not.
fn exit(p: vec3f, direction: vec3f, pixel: vec2f) -> vec4f {
    var found = vec4f(0.0);
    var at = pixel;
    for (var k = 0; k < 3; k++) {
        let texel = clamp(vec2i(at), vec2i(0), vec2i(camera.viewport) - 1);
        let z = textureLoad(back_z, texel, 0).x;
        if z == 0.0 {
            break;
        }
        // Towards the plane that the pixel shows.
        let q = (camera.world_from_view * vec4f(eye_from_pixel(at, z), 1.0)).xyz;
        let normal = world_from_eye_vector(textureLoad(back_normal, texel, 0).xyz);
        let t = dot(q - p, normal) / max(dot(direction, normal), 0.2);
        if t <= 0.0 {
            break;
        }
        found = vec4f(normal, min(t, 2.0 * distance(p, q)));
        at = pixel_from_eye(eye_from_world_point(p + found.w * direction));
    }
    return found;
}

/// Rays whose light is still to be looked up: gathered first and followed in one place, which keeps the shader short.
struct Rays {
    count: u32,
    p: array<vec3f, 3>,
    direction: array<vec3f, 3>,
    share: array<vec3f, 3>,
    is_wet: array<bool, 3>,
}

fn add_ray(rays: ptr<function, Rays>, p: vec3f, direction: vec3f, share: vec3f, is_wet: bool) {
    let i = (*rays).count;
    if any(share > vec3f(0.0)) && i < 3u {
        (*rays).p[i] = p;
        (*rays).direction[i] = direction;
        (*rays).share[i] = share;
        (*rays).is_wet[i] = is_wet;
        (*rays).count = i + 1u;
    }
}

/// Light that comes against a ray: of pool, ground or sky, and under water of meshes too, without what the water takes on
/// the way. `footprint` is the width that a pixel has where the ray starts.
fn met(p: vec3f, towards: vec3f, starts_wet: bool, footprint: f32) -> vec3f {
    var direction = towards;
    var is_wet = starts_wet;
    var hit = pool_hit(p, direction);
    if !is_wet && hit.kind != NOTHING && direction.y < 0.0 && under_water_m(p + hit.t * direction) > 0.0 {
        // Into the pool's water, as if that were level and began here.
        is_wet = true;
        direction = bend_in(direction, vec3f(0.0, 1.0, 0.0), light_screen.ior).direction;
        hit = pool_hit(p, direction);
    }
    var light = textureSampleLevel(sky_cube, linear_clamp, direction, 0.0).rgb;
    var way = select(0.0, min(hit.t, in_box_m(p, direction)), is_wet);
    var mesh = SliceHit(vec3f(0.0), 1.0);
    if is_wet {
        mesh = slice_hit(p, direction, hit.t);
    }
    if mesh.left > 0.0 && hit.kind != NOTHING {
        let slant = max(abs(dot(hit.normal, direction)), 0.1);
        let color = pool_color(p + hit.t * direction, hit.normal, hit.kind, footprint / slant);
        light = color.rgb + (1.0 - color.a) * light;
        // What goes up has left the water somewhere.
        way = select(way, hit.t, is_wet && direction.y <= 0.0);
    }
    return mesh.light + mesh.left * light * transmitted(plane_stack.absorption, way);
}

/// What a surface seen from outside sends: what it mirrors, and what comes through the water and out of it again.
fn from_outside(rays: ptr<function, Rays>, p: vec3f, view: vec3f, facing: vec3f, pixel: vec2f) {
    let reflectance = fresnel(clamp(-dot(view, facing), 0.0, 1.0), light_screen.ior);
    add_ray(rays, p, reflect(view, facing), vec3f(reflectance), false);
    var inner = bend_in(view, facing, light_screen.ior).direction;
    var start = p;
    var share = vec3f(1.0 - reflectance);
    let leaves = exit(p, inner, pixel);
    if leaves.w > 0.0 {
        start += leaves.w * inner;
        share *= transmitted(plane_stack.absorption, leaves.w);
        let out = bend_out(inner, -leaves.xyz, light_screen.ior);
        add_ray(rays, start, out.direction, (1.0 - out.reflectance) * share, false);
        share *= out.reflectance;
        inner = reflect(inner, -leaves.xyz);
    }
    add_ray(rays, start, inner, share, true);
}

/// The same from inside, where the surface may reflect everything; the way from the eye to it absorbs too.
fn from_inside(rays: ptr<function, Rays>, p: vec3f, view: vec3f, facing: vec3f, way_m: f32) {
    let out = bend_out(view, facing, light_screen.ior);
    let left = transmitted(plane_stack.absorption, way_m);
    add_ray(rays, p, reflect(view, facing), out.reflectance * left, true);
    add_ray(rays, p, out.direction, (1.0 - out.reflectance) * left, false);
}

@fragment
fn seen(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let z = textureLoad(water_z, texel, 0).x;
    let dry = textureLoad(dry_z, texel, 0).x;
    let inside = eye[0] < 0.0;
    let ray = normalize(eye_ray(position.xy).direction);
    if z == 0.0 || (dry != 0.0 && dry > z) {
        let way = select(0.0, dry / ray.z, inside);
        return textureLoad(dry_color, texel, 0) * vec4f(transmitted(plane_stack.absorption, way), 1.0);
    }
    let p_in_view = eye_from_pixel(position.xy, z);
    let p = (camera.world_from_view * vec4f(p_in_view, 1.0)).xyz;
    let view = world_from_eye_vector(ray);
    let normal = eye[0] * world_from_eye_vector(textureLoad(water_normal, texel, 0).xyz);
    // A blended normal may face away at the rim.
    let facing = normalize(normal - max(dot(normal, view) + 0.02, 0.0) * view);
    let footprint = length(p_in_view) * 2.0 / (camera.viewport.y * abs(camera.clip_from_view[1][1]));
    var rays: Rays;
    if inside {
        from_inside(&rays, p, view, facing, length(p_in_view));
    } else {
        from_outside(&rays, p, view, facing, position.xy);
    }
    var light = vec3f(0.0);
    for (var i = 0u; i < rays.count; i++) {
        light += rays.share[i] * met(rays.p[i], rays.direction[i], rays.is_wet[i], footprint);
    }
    return vec4f(light, 1.0);
}
