// Each particle's discs of intersection with four grid planes, added up in four channels (Iwasaki et al. 2006, section
// 4.2 and equation 1).
#import "lib/kernel.wgsl"
#import "lib/packed.wgsl"

struct Params {
    slab: u32,
    corner: vec2f,
    origin: vec3f,
    spacing: f32,
    reach_m: f32,
    peak: f32,
    columns: u32,
    rows: u32,
    kernel: u32,
}

struct Disc {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) middle: vec2f,
    // Squared distances of the four planes, in effective radii.
    @location(1) @interpolate(flat) away: vec4f,
}

const TABLE = 1u;

var<uniform> params: Params;
var<storage, read> sorted: array<Packed3>;
var<storage, read> slab_first: array<u32>;
var lookup: texture_2d<f32>;

@vertex
fn disc(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Disc {
    let p = (unpack3(sorted[slab_first[params.slab] + instance]) - params.origin) / params.spacing;
    let reach = params.reach_m / params.spacing;
    let planes = 4.0 * f32(params.slab) + vec4f(0.0, 1.0, 2.0, 3.0);
    let away = (planes - p.y) / reach;
    var out: Disc;
    out.middle = p.xz;
    out.away = away * away;
    let nearest = min(min(out.away.x, out.away.y), min(out.away.z, out.away.w));
    // The largest of the four discs, with half a cell for rounding; none where no plane is met.
    let radius = reach * sqrt(max(1.0 - nearest, 0.0)) + select(0.5, -1.0e9, nearest >= 1.0);
    let side = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    // Grid point i lies in the middle of pixel i.
    let pixel = p.xz + max(radius, 0.0) * side + 0.5;
    let ndc = pixel / vec2f(f32(params.columns), f32(params.rows)) * 2.0 - 1.0;
    out.clip = vec4f(ndc.x, -ndc.y, 0.5, 1.0);
    return out;
}

/// The paper's lookup, with the mean of neighbouring texels done here: 32-bit floats need not be filterable.
fn looked_up(a_2: f32) -> f32 {
    let at = sqrt(min(a_2, 1.0)) * 1023.0;
    let i = min(i32(at), 1022);
    let low = textureLoad(lookup, vec2i(i, 0), 0).x;
    let high = textureLoad(lookup, vec2i(i + 1, 0), 0).x;
    return mix(low, high, at - f32(i));
}

@fragment
fn density(in: Disc) -> @location(0) vec4f {
    let point = floor(in.clip.xy) - params.corner;
    let beside = (point - in.middle) * (params.spacing / params.reach_m);
    let a_2 = in.away + dot(beside, beside);
    if params.kernel == TABLE {
        return params.peak * vec4f(looked_up(a_2.x), looked_up(a_2.y), looked_up(a_2.z), looked_up(a_2.w));
    }
    return params.peak * vec4f(bracket(a_2.x), bracket(a_2.y), bracket(a_2.z), bracket(a_2.w));
}
