// Where each cell begins among the sorted particles, by bisection; one past the last cell stands their count.
#import "lib/dispatch.wgsl"

struct Params {
    particles_count: u32,
    cells: u32,
}

var<uniform> params: Params;
var<storage, read> sort_pairs: array<vec2u>;
var<storage, read_write> cell_start: array<u32>;

@compute @workgroup_size(256)
fn starts(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let cell = linear_index(id, groups, 256u);
    if cell > params.cells {
        return;
    }
    var low = 0u;
    var high = params.particles_count;
    while low < high {
        let middle = (low + high) / 2u;
        if sort_pairs[middle].x < cell {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    cell_start[cell] = low;
}
