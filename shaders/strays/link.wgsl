// Joins each particle's group with those of its near neighbours, in the order of the grid's cells.
#import "lib/dispatch.wgsl"
#import "lib/groups.wgsl"
#import "lib/neighbours.wgsl"

struct Params {
    particles_count: u32,
    reach_m: f32,
    candidates_max: u32,
}

var<uniform> params: Params;

@compute @workgroup_size(64)
fn link(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let own = linear_index(id, groups, 64u);
    if own >= params.particles_count {
        return;
    }
    let p = sorted_position(grid_sorted[own]);
    let cell = grid_cell(p);
    let stride = stride_around(cell, params.candidates_max);
    for (var k = 0u; k < RUNS; k++) {
        let run = run_around(cell, k);
        // Of a pair one is enough; of a heap that is sampled, both must try.
        let end = select(run.y, min(run.y, own), stride == 1u);
        for (var j = run.x; j < end; j += stride) {
            let offset = sorted_position(grid_sorted[j]) - p;
            if dot(offset, offset) <= params.reach_m * params.reach_m {
                join_groups(own, j);
            }
        }
    }
}
