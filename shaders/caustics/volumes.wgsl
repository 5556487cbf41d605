// Illumination volumes cut by a sample plane: three neighbouring beams give a triangle, in which their flux is spread
// (Iwasaki et al. 2006, section 5.1 and equation 2 without the receiver).
#import "lib/beams.wgsl"

struct Params {
    plane: u32,
    planes: u32,
    plane_px: u32,
    split: u32,
}

struct Quads {
    count: u32,
    items: array<vec2u>,
}

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) irradiance: vec3f,
}

/// A triangle with a smaller standard deviation than this, in texels, is widened if its light is concentrated: slivers fall
/// between the pixels or glare on one. Others meet as many pixels as their light needs, and tile the plane seamlessly.
const NARROWEST = 0.35;
const CONCENTRATED = 4.0;

var<uniform> params: Params;
var<storage, read> parts: array<u32>;
var<storage, read> quads: Quads;

/// Whether the cells on both sides of an edge are cut into pixels; beyond the screen all are.
fn both_cut(cell: vec2i, other: vec2i, cells: vec2i) -> bool {
    let one = any(cell < vec2i(0)) || any(cell >= cells) || parts[u32(cell.y * cells.x + cell.x)] > 1u;
    let two = any(other < vec2i(0)) || any(other >= cells) || parts[u32(other.y * cells.x + other.x)] > 1u;
    return one && two;
}

/// A pixel's beam; on the edge of a cell that is not cut, one between those at its ends, so that nothing gapes.
fn hit_in_list(pixel: vec2u, height: f32) -> Hit {
    let cells = vec2i((textureDimensions(beam_start) - 1u) / params.split);
    let cell = vec2i(pixel / params.split);
    let inner = pixel % params.split;
    let on_edge = vec2<bool>(inner.x == 0u, inner.y == 0u);
    if all(on_edge) || !any(on_edge) {
        return hit(pixel, height);
    }
    let across = select(vec2i(0, 1), vec2i(1, 0), on_edge.x);
    if both_cut(cell, cell - across, cells) {
        return hit(pixel, height);
    }
    let along = select(inner.x, inner.y, on_edge.x);
    let first = pixel - inner;
    let one = hit(first, height);
    let two = hit(first + vec2u(vec2i(1) - across) * params.split, height);
    let share = f32(along) / f32(params.split);
    return Hit(mix(one.at, two.at, share), mix(one.left, two.left, share));
}

/// Each pixel of the screen with its neighbours.
@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    let across = textureDimensions(beam_start).x - 1u;
    let first = vec2u(index / 6u % across, index / 6u / across);
    let height = plane_height();
    let at = corners_of(index % 6u);
    if at_rim(first + at[0], first + at[1], first + at[2]) {
        return past_rim(index % 3u, first, at, 1u, height);
    }
    return spread(index % 3u, hit(first + at[0], height), hit(first + at[1], height), hit(first + at[2], height), 1.0);
}

/// The quads of a list, of different sizes.
@vertex
fn listed(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Corner {
    let quad = quads.items[instance];
    let first = vec2u(quad.x & 0xffffu, quad.x >> 16u);
    let height = plane_height();
    let at = corners_of(index);
    if at_rim(first + quad.y * at[0], first + quad.y * at[1], first + quad.y * at[2]) {
        return past_rim(index % 3u, first, at, quad.y, height);
    }
    let hits = array<Hit, 3>(
        hit_in_list(first + quad.y * at[0], height),
        hit_in_list(first + quad.y * at[1], height),
        hit_in_list(first + quad.y * at[2], height),
    );
    return spread(index % 3u, hits[0], hits[1], hits[2], f32(quad.y));
}

/// Whether some of three beams meet water and some do not: what lies between them is not spread from one to the other.
fn at_rim(a: vec2u, b: vec2u, c: vec2u) -> bool {
    return is_wet(a) != is_wet(b) || is_wet(b) != is_wet(c);
}

/// Such light passes the water.
fn past_rim(k: u32, first: vec2u, at: array<vec2u, 3>, step: u32, height: f32) -> Corner {
    let a = straight_hit(first + step * at[0], height);
    let b = straight_hit(first + step * at[1], height);
    let c = straight_hit(first + step * at[2], height);
    return spread(k, a, b, c, f32(step));
}

fn plane_height() -> f32 {
    return mix(light_screen.top_m, light_screen.bottom_m, f32(params.plane) / f32(params.planes - 1u));
}

/// Corners of the triangle that vertices 0 to 2, or 3 to 5, of a quad belong to.
fn corners_of(index: u32) -> array<vec2u, 3> {
    return array<vec2u, 3>(select(vec2u(0u), vec2u(1u), index >= 3u), vec2u(1u, 0u), vec2u(0u, 1u));
}

/// Corner k of the triangle between three beams, which lie so many pixels apart on the screen.
fn spread(k: u32, first: Hit, second: Hit, third: Hit, apart_px: f32) -> Corner {
    // All in parts of the plane, from 0 to 1.
    let region = light_screen.region_max - light_screen.region_min;
    let a = (first.at - light_screen.region_min) / region;
    let b = (second.at - light_screen.region_min) / region;
    let c = (third.at - light_screen.region_min) / region;

    let corners = screen_corners();
    let cell_m = apart_px * (corners.zw - corners.xy) / light_screen.screen_px;
    // Flux through half a quad of the screen, as a share of the plane's area: equation 2's cosine and F_q in one.
    let flux = irradiance(sun) * max(-sun.direction.y, 0.0) * 0.5 * cell_m.x * cell_m.y / (region.x * region.y);
    let area = 0.5 * abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));

    // Second moments of the triangle, in texels: what stands for it has the same or more.
    let texels = vec2f(f32(params.plane_px));
    let ab = (b - a) * texels;
    let bc = (c - b) * texels;
    let ca = (a - c) * texels;
    let xx = (ab.x * ab.x + bc.x * bc.x + ca.x * ca.x) / 36.0;
    let yy = (ab.y * ab.y + bc.y * bc.y + ca.y * ca.y) / 36.0;
    let xy = (ab.x * ab.y + bc.x * bc.y + ca.x * ca.y) / 36.0;
    let half_trace = 0.5 * (xx + yy);
    let root = sqrt(max(0.25 * (xx - yy) * (xx - yy) + xy * xy, 0.0));
    let wide = sqrt(half_trace + root);
    let narrow = sqrt(max(half_trace - root, 0.0));

    var out: Corner;
    var at = vec2f(0.0);
    let before = 0.5 * cell_m.x * cell_m.y / (region.x * region.y);
    if narrow >= NARROWEST || CONCENTRATED * area >= before {
        at = select(select(c, b, k == 1u), a, k == 0u);
        let left = select(select(third.left, second.left, k == 1u), first.left, k == 0u);
        out.irradiance = flux * left / area;
    } else {
        // A triangle with moments 1 in both directions, stretched: its corners lie sqrt(8) from its middle.
        let deviations = max(vec2f(wide, narrow), vec2f(NARROWEST));
        var axis = vec2f(xy, half_trace + root - xx);
        if abs(axis.x) + abs(axis.y) < 1.0e-12 {
            axis = select(vec2f(0.0, 1.0), vec2f(1.0, 0.0), xx >= yy);
        }
        axis = normalize(axis);
        let turn = f32(k) * 2.0943951;
        let side = 2.8284271 * vec2f(cos(turn), sin(turn)) * deviations;
        at = (a + b + c) / 3.0 + (side.x * axis + side.y * vec2f(-axis.y, axis.x)) / texels;
        let left = (first.left + second.left + third.left) / 3.0;
        out.irradiance = flux * left * texels.x * texels.y / (10.3923048 * deviations.x * deviations.y);
    }
    out.clip = vec4f(at.x * 2.0 - 1.0, 1.0 - 2.0 * at.y, 0.5, 1.0);
    if !sun_shines() {
        out.clip = vec4f(2.0, 2.0, 0.5, 1.0);
    }
    return out;
}

@fragment
fn add(in: Corner) -> @location(0) vec4f {
    return vec4f(in.irradiance, 1.0);
}
