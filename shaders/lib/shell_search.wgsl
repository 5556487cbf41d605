// Where a ray meets the depth layers of shells, by the secant method (Imai 2016, section 4.4; Imai 2014). A texture holds
// the layers as channels: front and back of the body in x and y, front and back of the splashes in z and w.
#import "lib/camera.wgsl"

const BODY = 0u;
const SPLASH = 1u;

struct Crossing {
    found: bool,
    // BODY or SPLASH.
    shell: u32,
    // Distance along the ray, in the direction's units.
    t: f32,
    pixel: vec2f,
}

/// Eye z of a channel between the pixels' centres, from those of the four around that have a surface; 0 if none has.
fn layer_z(layers: texture_2d<f32>, channel: u32, pixel: vec2f) -> f32 {
    let most = vec2i(textureDimensions(layers)) - 1;
    let from_centre = pixel - 0.5;
    let corner = vec2i(floor(from_centre));
    let low = clamp(corner, vec2i(0), most);
    let high = clamp(corner + 1, vec2i(0), most);
    let z = vec4f(
        textureLoad(layers, low, 0)[channel],
        textureLoad(layers, vec2i(high.x, low.y), 0)[channel],
        textureLoad(layers, vec2i(low.x, high.y), 0)[channel],
        textureLoad(layers, high, 0)[channel],
    );
    let part = from_centre - floor(from_centre);
    let across = vec4f(1.0 - part.x, part.x, 1.0 - part.x, part.x);
    let down = vec4f(1.0 - part.y, 1.0 - part.y, part.y, part.y);
    let weights = select(across * down, vec4f(0.0), z == vec4f(0.0));
    let weight = weights.x + weights.y + weights.z + weights.w;
    return select(0.0, dot(weights, z) / weight, weight >= 0.25);
}

/// From a point inside a shell to its back. Past the silhouette the ray counts as outside, so that the search then
/// closes in on the shell's rim. `found` is false only if the ray is still inside after `reach`.
fn leave_shell(layers: texture_2d<f32>, shell: u32, p: vec3f, direction: vec3f, reach: f32, steps: u32) -> Crossing {
    let channel = 2u * shell + 1u;
    var inside = 0.0;
    var gap_inside = 0.0;
    var outside = reach;
    var gap_outside = 0.0;
    var bracketed = false;
    // The far end's gap is known only where the layer has a surface.
    var measured = false;
    var t = 0.0;
    // The step after the start is a guess; then come `steps` steps of the search.
    for (var k = 0u; k <= steps; k++) {
        let q = p + t * direction;
        let z = layer_z(layers, channel, pixel_from_eye(q));
        let gap = q.z - z;
        let within = z != 0.0 && gap > 0.0;
        if k == 0u {
            if !within {
                bracketed = true;
                break;
            }
            gap_inside = gap;
            // First guess: the back goes on as far behind as it is here.
            t = min(gap / max(-direction.z, 0.1), reach);
            continue;
        }
        if within {
            let slope = (gap - gap_inside) / max(t - inside, 1.0e-9);
            inside = t;
            gap_inside = gap;
            if !bracketed {
                if t >= reach {
                    break;
                }
                // The secant through the last two points, but no leap.
                t = min(t + clamp(-gap / min(slope, -1.0e-3), 0.25 * t, 2.0 * t), reach);
                continue;
            }
            // Illinois: an end that stays loses half its weight.
            gap_outside *= 0.5;
        } else {
            outside = t;
            bracketed = true;
            measured = z != 0.0;
            gap_outside = gap;
        }
        let share = select(0.5, clamp(gap_inside / (gap_inside - gap_outside), 0.02, 0.98), measured);
        t = mix(inside, outside, share);
    }
    if bracketed && !measured {
        t = inside;
    }
    return Crossing(bracketed, shell, t, pixel_from_eye(p + t * direction));
}

/// From a point in the air to the next front of either shell: marches outwards in growing steps, then closes in by
/// secants. A ray that starts inside must leave first. Hits count only between front and back.
fn enter_shells(layers: texture_2d<f32>, p: vec3f, direction: vec3f, reach: f32, march_steps: u32, steps: u32) -> Crossing {
    var ts = vec2f(0.0);
    var gaps = vec4f(0.0);
    var was_outside = vec2<bool>(false);
    var found = vec2<bool>(false);
    for (var k = 0u; k <= march_steps; k++) {
        let share = f32(k) / f32(march_steps);
        let t = reach * share * share;
        let q = p + t * direction;
        let pixel = pixel_from_eye(q);
        if q.z > -camera.near || !on_screen(pixel) {
            break;
        }
        let z = textureLoad(layers, vec2i(pixel), 0);
        let gap = q.z - z.xz;
        let inside = (z.xz != vec2f(0.0)) & (gap <= vec2f(0.0)) & (vec2f(q.z) >= z.yw);
        ts = vec2f(ts.y, t);
        // Only in front of the surface is there something to draw a secant from.
        gaps = vec4f(gaps.zw, select(gap, vec2f(0.0), z.xz == vec2f(0.0)));
        found = inside & was_outside;
        if any(found) {
            break;
        }
        was_outside = was_outside | !inside;
    }
    if !any(found) {
        return Crossing(false, BODY, reach, vec2f(0.0));
    }
    // Both within one step is rare; the splash is then the smaller thing, in front of the body.
    let shell = select(BODY, SPLASH, found.y);
    var t_out = ts.x;
    var t_in = ts.y;
    var gap_out = gaps[shell];
    var gap_in = gaps[2u + shell];
    for (var k = 0u; k < steps; k++) {
        let share = select(0.5, clamp(gap_out / (gap_out - gap_in), 0.02, 0.98), gap_out > 0.0);
        let t = mix(t_out, t_in, share);
        let q = p + t * direction;
        let z = layer_z(layers, 2u * shell, pixel_from_eye(q));
        if z != 0.0 && q.z <= z {
            t_in = t;
            gap_in = q.z - z;
            gap_out *= 0.5;
        } else {
            t_out = t;
            gap_out = select(0.0, q.z - z, z != 0.0);
            gap_in *= 0.5;
        }
    }
    return Crossing(true, shell, t_in, pixel_from_eye(p + t_in * direction));
}

/// The way out of a sphere, given what `leave_shell` found within a little more than its diameter. The shell's farthest
/// back may belong to another sphere behind this one; then the way is the chord that radius and outward normal tell.
fn leave_sphere(back: Crossing, p: vec3f, direction: vec3f, normal: vec3f, radius: f32) -> Crossing {
    if back.found {
        return back;
    }
    let chord = max(-2.0 * radius * dot(normal, direction), 0.0);
    return Crossing(false, back.shell, chord, pixel_from_eye(p + chord * direction));
}

/// How far to look for the back of a sphere, in radii.
const SPHERE_REACH = 2.1;

/// Unit normal of a layer between the pixels' centres; towards the viewer where there is none.
fn layer_normal(normals: texture_2d_array<f32>, smoothly: sampler, layer: i32, pixel: vec2f) -> vec3f {
    let normal = textureSampleLevel(normals, smoothly, pixel / camera.viewport, layer, 0.0).xyz;
    let length_2 = dot(normal, normal);
    return select(vec3f(0.0, 0.0, 1.0), normal * inverseSqrt(length_2), length_2 > 0.0);
}

/// The normal turned against a direction; where a surface is seen from its edge it is tilted until it faces it.
fn facing(normal: vec3f, direction: vec3f) -> vec3f {
    let against = select(normal, -normal, dot(normal, direction) > 0.0);
    let cosine = -dot(against, direction);
    return normalize(against - direction * max(0.02 - cosine, 0.0));
}
