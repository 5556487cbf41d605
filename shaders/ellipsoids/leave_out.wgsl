// Strays are of no class: the body loses those that it had.
#import "lib/dispatch.wgsl"

struct Params {
    particles_count: u32,
}

var<uniform> params: Params;
var<storage, read> strays_stray: array<u32>;
var<storage, read_write> is_body: array<u32>;

@compute @workgroup_size(256)
fn leave_out(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 256u);
    if i < params.particles_count && strays_stray[i] != 0u {
        is_body[i] = 0u;
    }
}
