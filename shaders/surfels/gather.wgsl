// Positions in the order of their clusters.
#import "lib/dispatch.wgsl"
#import "lib/packed.wgsl"

struct Params {
    particles_count: u32,
}

var<uniform> params: Params;
var<storage, read> particles_position: array<Packed3>;
var<storage, read> sort_pairs: array<vec2u>;
var<storage, read_write> sorted: array<Packed3>;

@compute @workgroup_size(256)
fn gather(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 256u);
    if i < params.particles_count {
        sorted[i] = particles_position[sort_pairs[i].y];
    }
}
