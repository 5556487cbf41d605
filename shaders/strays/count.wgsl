// How many particles each group has, counted at its root, at which all members point from now on.
#import "lib/dispatch.wgsl"
#import "lib/groups.wgsl"

struct Params {
    particles_count: u32,
}

var<uniform> params: Params;
var<storage, read_write> size: array<atomic<u32>>;

@compute @workgroup_size(256)
fn count(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 256u);
    if i >= params.particles_count {
        return;
    }
    let root = root_of(i);
    atomicMin(&group[i], root);
    atomicAdd(&size[root], 1u);
}
