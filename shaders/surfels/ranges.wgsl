// Which particles each slab of four grid planes draws: the clusters within reach (Iwasaki et al. 2006, section 4.1).
// One past the last slab draws nothing.
#import "lib/dispatch.wgsl"

struct Params {
    origin: vec3f,
    spacing: f32,
    low: vec3f,
    reach_m: f32,
    cluster_m: f32,
    clusters: u32,
    slabs: u32,
}

/// Arguments of an indirect draw.
struct Arguments {
    vertices: u32,
    instances: u32,
    first_vertex: u32,
    first_instance: u32,
}

var<uniform> params: Params;
var<storage, read> cluster_start: array<u32>;
var<storage, read_write> slab_args: array<Arguments>;
var<storage, read_write> slab_first: array<u32>;

/// The cluster at a height, rounded down; the slack outweighs the rounding of the keys.
fn cluster_at(y: f32, slack: f32) -> u32 {
    let layer = (y - params.low.y) / params.cluster_m + slack;
    return u32(clamp(layer, 0.0, f32(params.clusters - 1u)));
}

@compute @workgroup_size(64)
fn ranges(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let slab = linear_index(id, groups, 64u);
    if slab > params.slabs {
        return;
    }
    let lowest = params.origin.y + 4.0 * f32(slab) * params.spacing;
    let first = cluster_start[cluster_at(lowest - params.reach_m, -0.01)];
    let end = cluster_start[cluster_at(lowest + 3.0 * params.spacing + params.reach_m, 0.01) + 1u];
    slab_args[slab] = Arguments(4u, select(end - first, 0u, slab == params.slabs), 0u, 0u);
    slab_first[slab] = first;
}
