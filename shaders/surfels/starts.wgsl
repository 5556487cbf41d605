// Where each cluster begins among the sorted particles, by bisection; the last place is the count of those that count.
#import "lib/dispatch.wgsl"

struct Params {
    particles_count: u32,
    clusters: u32,
}

var<uniform> params: Params;
var<storage, read> sort_pairs: array<vec2u>;
var<storage, read_write> cluster_start: array<u32>;

@compute @workgroup_size(256)
fn starts(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let cluster = linear_index(id, groups, 256u);
    if cluster > params.clusters {
        return;
    }
    var low = 0u;
    var high = params.particles_count;
    while low < high {
        let middle = (low + high) / 2u;
        if sort_pairs[middle].x < cluster {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    cluster_start[cluster] = low;
}
