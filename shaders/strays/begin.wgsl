// Each particle is a group of its own, and no group has members yet.
#import "lib/dispatch.wgsl"

struct Params {
    particles_count: u32,
}

var<uniform> params: Params;
var<storage, read_write> group: array<atomic<u32>>;
var<storage, read_write> size: array<atomic<u32>>;

@compute @workgroup_size(256)
fn begin(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 256u);
    if i >= params.particles_count {
        return;
    }
    atomicStore(&group[i], i);
    atomicStore(&size[i], 0u);
}
