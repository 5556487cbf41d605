// Marks the particles of small groups, by their numbers in the file.
#import "lib/dispatch.wgsl"
#import "lib/sorted.wgsl"

struct Params {
    particles_count: u32,
    below: u32,
}

var<uniform> params: Params;
var<storage, read> grid_sorted: array<Sorted>;
var<storage, read> group: array<u32>;
var<storage, read> size: array<u32>;
var<storage, read_write> stray: array<u32>;

@compute @workgroup_size(256)
fn mark(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 256u);
    if i >= params.particles_count {
        return;
    }
    stray[grid_sorted[i].particle] = select(0u, 1u, size[group[i]] < params.below);
}
