// Each particle's discs of intersection with four grid planes, added up in four channels (Iwasaki et al. 2006, section
// 4.2 and equation 1): `in_atlas` for all slabs at once, `in_slab` for one. Each slab has a tile of the target.
#import "lib/kernel.wgsl"
#import "lib/mirrors.wgsl"
#import "lib/packed.wgsl"

struct Params {
    origin: vec3f,
    spacing: f32,
    reach_m: f32,
    peak: f32,
    columns: u32,
    rows: u32,
    kernel: u32,
    // Tiles in a row, and how many there are.
    tiles: u32,
    held: u32,
}

struct Atlas {
    slabs: u32,
    particles_count: u32,
    clusters: u32,
}

struct Disc {
    @builtin(position) clip: vec4f,
    // The particle's place among the grid points, and the pixel at which these begin: apart, since a sum would be rounded.
    @location(0) @interpolate(flat) middle: vec2f,
    @location(2) @interpolate(flat) tile_corner: vec2f,
    // Squared distances of the four planes, in effective radii, and those from its image below the floor.
    @location(1) @interpolate(flat) away: vec4f,
    @location(3) @interpolate(flat) away_below: vec4f,
    // The place of its images behind walls.
    @location(4) @interpolate(flat) image: vec2f,
}

const TABLE = 1u;

var<uniform> params: Params;
var<uniform> atlas_of: Atlas;
var<uniform> slab: u32;
var<storage, read> sorted: array<Packed3>;
var<storage, read> slab_first: array<u32>;
var<storage, read> cluster_start: array<u32>;
var lookup: texture_2d<f32>;

fn squared(x: vec4f) -> vec4f {
    return x * x;
}

/// A quad around the particle's largest disc among a slab's planes and those of its images, in the slab's tile; no area
/// where none is met.
fn quad(p_m: vec3f, slab_index: u32, corner: u32) -> Disc {
    let tile = slab_index % params.held;
    let edges = vec2f(f32(params.columns), f32(params.rows));
    let tile_corner = edges * vec2f(vec2u(tile % params.tiles, tile / params.tiles));
    let size = edges * vec2f(vec2u(params.tiles, (params.held + params.tiles - 1u) / params.tiles));
    let p = (p_m - params.origin) / params.spacing;
    let image = (mirrored(p_m) - params.origin) / params.spacing;
    let reach = params.reach_m / params.spacing;
    let planes = 4.0 * f32(slab_index) + vec4f(0.0, 1.0, 2.0, 3.0);
    var out: Disc;
    out.away = squared((planes - p.y) / reach);
    // Below the floor an image counts where its particle does too, so that both layouts see the same ones.
    out.away_below = select(squared((planes - image.y) / reach), vec4f(1.0), out.away >= vec4f(1.0));
    let each = min(out.away, out.away_below);
    let nearest = min(min(each.x, each.y), min(each.z, each.w));
    // Half a cell more, for rounding.
    let radius = select(reach * sqrt(max(1.0 - nearest, 0.0)) + 0.5, 0.0, nearest >= 1.0);
    // Grid point i lies in the middle of pixel i.
    out.middle = p.xz;
    out.image = image.xz;
    out.tile_corner = tile_corner;
    let has_image = image.xz < vec2f(0.5 * NO_IMAGE);
    let low = select(p.xz, min(p.xz, image.xz), has_image) - radius;
    let high = select(p.xz, max(p.xz, image.xz), has_image) + radius;
    let side = vec2<bool>((corner & 1u) == 1u, (corner >> 1u) == 1u);
    // Images may reach beyond the grid, whose tile none leaves.
    let at = clamp(select(low, high, side) + 0.5, vec2f(0.0), edges);
    let ndc = (tile_corner + at) / size * 2.0 - 1.0;
    out.clip = vec4f(ndc.x, -ndc.y, 0.5, 1.0);
    return out;
}

@vertex
fn in_slab(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Disc {
    let p = unpack3(sorted[slab_first[slab] + instance]);
    return quad(p, slab, corner);
}

/// Instances are all particles for the lowest slab that each meets, by height, then for the next one, and so on: what
/// follows each other falls into one tile.
@vertex
fn in_atlas(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Disc {
    let i = instance % atlas_of.particles_count;
    let p = unpack3(sorted[i]);
    let lowest = ceil((p.y - params.reach_m - params.origin.y) / params.spacing - 0.01);
    let slab_index = u32(max(lowest, 0.0)) / 4u + instance / atlas_of.particles_count;
    var out = quad(p, slab_index, corner);
    // What does not count stands behind the clusters.
    if i >= cluster_start[atlas_of.clusters] || slab_index >= atlas_of.slabs {
        out.clip = vec4f(2.0, 2.0, 0.5, 1.0);
    }
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

/// Equation 1 on four planes, by squared distances.
fn bracket_4(a_2: vec4f) -> vec4f {
    if params.kernel == TABLE {
        return vec4f(looked_up(a_2.x), looked_up(a_2.y), looked_up(a_2.z), looked_up(a_2.w));
    }
    return vec4f(bracket(a_2.x), bracket(a_2.y), bracket(a_2.z), bracket(a_2.w));
}

/// The sum over a particle and its images behind walls, at one height.
fn with_images(away: vec4f, own: vec2f, image: vec2f) -> vec4f {
    var sum = bracket_4(away + own.x + own.y);
    if image.x < 1.0 {
        sum += bracket_4(away + image.x + own.y);
    }
    if image.y < 1.0 {
        sum += bracket_4(away + own.x + image.y);
        if image.x < 1.0 {
            sum += bracket_4(away + image.x + image.y);
        }
    }
    return sum;
}

@fragment
fn density(in: Disc) -> @location(0) vec4f {
    let at = floor(in.clip.xy) - in.tile_corner;
    let own = (at - in.middle) * (params.spacing / params.reach_m);
    let image = (at - in.image) * (params.spacing / params.reach_m);
    var sum = with_images(in.away, own * own, image * image);
    if any(in.away_below < vec4f(1.0)) {
        sum += with_images(in.away_below, own * own, image * image);
    }
    return params.peak * sum;
}
