// Where a ray meets the depth layers of a shell (front: layer 0, back: layer 1), by the secant method (Imai 2016,
// section 4.4; Imai 2014).
#import "lib/camera.wgsl"

struct Crossing {
    found: bool,
    // Distance along the ray, in the direction's units.
    t: f32,
    pixel: vec2f,
}

/// Eye z of a layer between the pixels' centres, from those of the four around that have a surface; 0 if none has.
fn layer_z(shell_z: texture_2d_array<f32>, layer: i32, pixel: vec2f) -> f32 {
    let size = vec2i(textureDimensions(shell_z));
    let from_centre = pixel - 0.5;
    let corner = vec2i(floor(from_centre));
    let part = from_centre - floor(from_centre);
    var sum = 0.0;
    var weight = 0.0;
    for (var k = 0; k < 4; k++) {
        let at = vec2i(k & 1, k >> 1u);
        let w = mix(1.0 - part, part, vec2f(at));
        let texel = clamp(corner + at, vec2i(0), size - 1);
        let z = textureLoad(shell_z, texel, layer, 0).x;
        if z != 0.0 {
            sum += w.x * w.y * z;
            weight += w.x * w.y;
        }
    }
    if weight < 0.25 {
        return 0.0;
    }
    return sum / weight;
}

/// From a point inside the shell to its back. Past the silhouette the ray counts as outside, so that the search then
/// closes in on the shell's rim. `found` is false only if the ray is still inside after `reach`.
fn leave_shell(shell_z: texture_2d_array<f32>, p: vec3f, direction: vec3f, reach: f32, steps: u32) -> Crossing {
    let start = pixel_from_eye(p);
    let z_start = layer_z(shell_z, 1, start);
    var inside = 0.0;
    var gap_inside = p.z - z_start;
    if z_start == 0.0 || gap_inside <= 0.0 {
        return Crossing(true, 0.0, start);
    }
    var outside = reach;
    var gap_outside = 0.0;
    var bracketed = false;
    // The far end's gap is known only where the layer has a surface.
    var measured = false;
    // First guess: the back goes on as far behind as it is here.
    var t = min(gap_inside / max(-direction.z, 0.1), reach);
    for (var k = 0u; k < steps; k++) {
        let q = p + t * direction;
        let z = layer_z(shell_z, 1, pixel_from_eye(q));
        let gap = q.z - z;
        if z != 0.0 && gap > 0.0 {
            let slope = (gap - gap_inside) / max(t - inside, 1.0e-9);
            inside = t;
            gap_inside = gap;
            if !bracketed {
                if t >= reach {
                    return Crossing(false, reach, pixel_from_eye(q));
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
        if measured {
            t = mix(inside, outside, clamp(gap_inside / (gap_inside - gap_outside), 0.02, 0.98));
        } else {
            t = 0.5 * (inside + outside);
        }
    }
    if bracketed && !measured {
        t = inside;
    }
    return Crossing(bracketed, t, pixel_from_eye(p + t * direction));
}

/// From a point on a sphere of a shell to its back. The shell's farthest back may belong to another sphere behind this
/// one; then `found` is false, and `t` is the chord that the radius and the outward `normal` tell.
fn leave_sphere(shell_z: texture_2d_array<f32>, p: vec3f, direction: vec3f, normal: vec3f, radius: f32, steps: u32) -> Crossing {
    let back = leave_shell(shell_z, p, direction, 2.1 * radius, steps);
    if back.found {
        return back;
    }
    let chord = max(-2.0 * radius * dot(normal, direction), 0.0);
    return Crossing(false, chord, pixel_from_eye(p + chord * direction));
}

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

/// From a point in the air to the front of a shell: marches outwards in growing steps, then closes in by secants.
/// A ray that starts inside must leave first. Hits count only between front and back.
fn enter_shell(shell_z: texture_2d_array<f32>, p: vec3f, direction: vec3f, reach: f32, march_steps: u32, steps: u32) -> Crossing {
    var ts = vec2f(0.0);
    var gaps = vec2f(0.0);
    var outside = false;
    var found = false;
    for (var k = 0u; k <= march_steps; k++) {
        let share = f32(k) / f32(march_steps);
        let t = reach * share * share;
        let q = p + t * direction;
        let pixel = pixel_from_eye(q);
        if q.z > -camera.near || !on_screen(pixel) {
            break;
        }
        let front = textureLoad(shell_z, vec2i(pixel), 0, 0).x;
        let gap = q.z - front;
        // Only in front of the surface is there something to draw a secant from.
        ts = vec2f(ts.y, t);
        gaps = vec2f(gaps.y, select(gap, 0.0, front == 0.0));
        let inside = front != 0.0 && gap <= 0.0 && q.z >= textureLoad(shell_z, vec2i(pixel), 1, 0).x;
        if inside && outside {
            found = true;
            break;
        }
        outside = outside || !inside;
    }
    if !found {
        return Crossing(false, reach, vec2f(0.0));
    }
    return close_in(shell_z, p, direction, ts, gaps, steps);
}

/// The crossing of a front layer between `ts`.x outside (in front of it by `gaps`.x; 0: unknown) and `ts`.y inside.
fn close_in(shell_z: texture_2d_array<f32>, p: vec3f, direction: vec3f, ts: vec2f, gaps: vec2f, steps: u32) -> Crossing {
    var t_out = ts.x;
    var t_in = ts.y;
    var gap_out = gaps.x;
    var gap_in = gaps.y;
    for (var k = 0u; k < steps; k++) {
        var share = 0.5;
        if gap_out > 0.0 {
            share = clamp(gap_out / (gap_out - gap_in), 0.02, 0.98);
        }
        let t = mix(t_out, t_in, share);
        let q = p + t * direction;
        let z = layer_z(shell_z, 0, pixel_from_eye(q));
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
    return Crossing(true, t_in, pixel_from_eye(p + t_in * direction));
}
