// The cluster of each particle: its layer by height (Iwasaki et al. 2006, section 4.1).
#import "lib/dispatch.wgsl"
#import "lib/packed.wgsl"

struct Params {
    particles_count: u32,
    keep_min: vec3f,
    keep_max: vec3f,
    low: vec3f,
    cluster_m: f32,
    clusters: u32,
}

var<uniform> params: Params;
var<storage, read> particles_position: array<Packed3>;
var<storage, read_write> keys: array<u32>;

@compute @workgroup_size(256)
fn cluster(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 256u);
    if i >= params.particles_count {
        return;
    }
    let p = unpack3(particles_position[i]);
    let layer = clamp((p.y - params.low.y) / params.cluster_m, 0.0, f32(params.clusters - 1u));
    // What does not count lies behind the last cluster.
    let kept = all(p >= params.keep_min) && all(p <= params.keep_max);
    keys[i] = select(params.clusters, u32(layer), kept);
}
