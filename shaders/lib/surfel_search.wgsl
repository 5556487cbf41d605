// Points of an iso-surface on the edges of a grid, and between them where they are far apart (Iwasaki et al. 2006,
// section 4.2).
#import "lib/density_planes.wgsl"
#import "lib/surfel.wgsl"

struct Params {
    origin: vec3f,
    spacing: f32,
    columns: u32,
    levels: u32,
    rows: u32,
    iso_level: f32,
    radius_m: f32,
    gap: f32,
}


var<uniform> params: Params;

const AXES = array<vec3i, 3>(vec3i(1, 0, 0), vec3i(0, 1, 0), vec3i(0, 0, 1));

/// Density at a grid point; nothing outside the grid.
fn field(at: vec3i) -> f32 {
    if any(at < vec3i(0)) || any(at >= vec3i(vec3u(params.columns, params.levels, params.rows))) {
        return 0.0;
    }
    return four_planes(at.xz, at.y >> 2u)[at.y & 3];
}

/// The gradient at a grid point per cell, by differences of fourth order.
fn gradient(at: vec3i) -> vec3f {
    var out = vec3f(0.0);
    for (var axis = 0u; axis < 3u; axis++) {
        let step = AXES[axis];
        out[axis] = (8.0 * (field(at + step) - field(at - step)) - field(at + 2 * step) + field(at - 2 * step)) / 12.0;
    }
    return out;
}

/// The cubic through values at -1, 0, 1 and 2.
fn cubic(f: vec4f, t: f32) -> f32 {
    let weights = vec4f(
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    );
    return dot(weights, f);
}

fn inside(density: f32) -> bool {
    return density >= params.iso_level;
}

/// Where between 0 and 1 the cubic meets the iso-level, of which its ends lie on different sides.
fn crossing(f: vec4f) -> f32 {
    var low = 0.0;
    var high = 1.0;
    let low_inside = inside(f.y);
    for (var k = 0; k < 16; k++) {
        let middle = 0.5 * (low + high);
        if inside(cubic(f, middle)) == low_inside {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

fn values_along(at: vec3i, step: vec3i) -> vec4f {
    return vec4f(field(at - step), field(at), field(at + step), field(at + 2 * step));
}

/// A point counted in cells, and the gradient there: 0 where there is no point.
struct Found {
    place: vec3f,
    slope: vec3f,
}

/// The point on the edge from a grid point along an axis; nothing if the surface does not cross it.
fn on_edge(at: vec3i, axis: u32) -> Found {
    let step = AXES[axis];
    let f = values_along(at, step);
    if inside(f.y) == inside(f.z) {
        return Found(vec3f(0.0), vec3f(0.0));
    }
    let t = crossing(f);
    return Found(vec3f(at) + t * vec3f(step), mix(gradient(at), gradient(at + step), t));
}

/// One more point in the middle of a face whose two crossings are far apart. The face spans axes u and v from `at`.
fn in_face(at: vec3i, u: u32, v: u32) -> Found {
    let du = AXES[u];
    let dv = AXES[v];
    let corners = vec4f(field(at), field(at + du), field(at + dv), field(at + du + dv));
    let sides = vec4<bool>(inside(corners.x), inside(corners.y), inside(corners.z), inside(corners.w));
    // Edges along u at v = 0 and 1, along v at u = 0 and 1.
    let crossed = vec4<bool>(sides.x != sides.y, sides.z != sides.w, sides.x != sides.z, sides.y != sides.w);
    if dot(vec4u(crossed), vec4u(1u)) != 2u {
        return Found(vec3f(0.0), vec3f(0.0));
    }
    let steps = (params.iso_level - corners.xzxy) / select(vec4f(1.0), corners.ywzw - corners.xzxy, crossed);
    var ends = array<vec2f, 4>(vec2f(steps.x, 0.0), vec2f(steps.y, 1.0), vec2f(0.0, steps.z), vec2f(1.0, steps.w));
    var first = vec2f(-1.0);
    var second = vec2f(0.0);
    for (var k = 0u; k < 4u; k++) {
        if crossed[k] {
            if first.x < 0.0 {
                first = ends[k];
            } else {
                second = ends[k];
            }
        }
    }
    let span = abs(second - first);
    if length(span) <= params.gap {
        return Found(vec3f(0.0), vec3f(0.0));
    }
    // Across the shorter extent of the segment, through its middle.
    let middle = 0.5 * (first + second);
    let along_u = span.x < span.y;
    let line = select(middle.x, middle.y, along_u);
    let step = select(dv, du, along_u);
    let side = select(du, dv, along_u);
    let f = vec4f(
        cubic(values_along(at - step, side), line),
        cubic(values_along(at, side), line),
        cubic(values_along(at + step, side), line),
        cubic(values_along(at + 2 * step, side), line),
    );
    if inside(f.y) == inside(f.z) {
        return Found(vec3f(0.0), vec3f(0.0));
    }
    let t = crossing(f);
    let near = mix(gradient(at), gradient(at + side), line);
    let far = mix(gradient(at + step), gradient(at + step + side), line);
    return Found(vec3f(at) + t * vec3f(step) + line * vec3f(side), mix(near, far, t));
}
