// Where neighbouring beams diverge: cells of the virtual screen whose inner beams land elsewhere than the four at their
// corners say are cut into pixels (the future work of Iwasaki et al. 2006: more samples where the light changes quickly).
#import "lib/beams.wgsl"

struct Params {
    split: u32,
    tolerance: f32,
    plane_px: u32,
    planes: u32,
}

var<uniform> params: Params;
/// How many quads stand for a cell: 1, or its pixels.
var<storage, read_write> parts: array<u32>;

/// How far, in texels of a plane, a pixel's beam lands from where the corners say.
fn off_px(first: vec2u, inner: vec2u, height: f32) -> f32 {
    let last = first + params.split;
    let share = vec2f(inner) / f32(params.split);
    let low = mix(hit(first, height).at, hit(vec2u(last.x, first.y), height).at, share.x);
    let high = mix(hit(vec2u(first.x, last.y), height).at, hit(last, height).at, share.x);
    let off = (hit(first + inner, height).at - mix(low, high, share.y)) / (light_screen.region_max - light_screen.region_min);
    return length(off) * f32(params.plane_px);
}

@compute @workgroup_size(8, 8)
fn diverge(@builtin(global_invocation_id) id: vec3u) {
    let cells = (textureDimensions(beam_start) - 1u) / params.split;
    if any(id.xy >= cells) {
        return;
    }
    let first = id.xy * params.split;
    let wet = is_wet(first);
    var apart = false;
    for (var k = 0u; k < (params.split + 1u) * (params.split + 1u) && !apart; k++) {
        let inner = vec2u(k % (params.split + 1u), k / (params.split + 1u));
        // What lies deeper is further apart, and waves may cross half-way.
        apart = is_wet(first + inner) != wet
            || off_px(first, inner, light_screen.bottom_m) > params.tolerance
            || off_px(first, inner, mix(light_screen.top_m, light_screen.bottom_m, 0.5)) > params.tolerance;
    }
    parts[id.y * cells.x + id.x] = select(1u, params.split * params.split, apart);
}
