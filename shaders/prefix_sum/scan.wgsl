// Exclusive prefix sum, 2,048 items a workgroup; one workgroup walks over the totals, so any length will do.
#import "lib/dispatch.wgsl"

const WIDTH = 256u;
const ITEMS = 8u;
const BLOCK = 2048u;

struct Params {
    total: u32,
    blocks: u32,
}

var<uniform> params: Params;
var<storage, read> values: array<u32>;
var<storage, read_write> sums: array<u32>;
var<storage, read_write> totals: array<u32>;

var<workgroup> partial: array<u32, 256>;

/// Sum of the threads' values before this one; `partial[WIDTH - 1]` then holds the whole.
fn exclusive(own: u32, lane: u32) -> u32 {
    partial[lane] = own;
    workgroupBarrier();
    for (var reach = 1u; reach < WIDTH; reach *= 2u) {
        var before = 0u;
        if lane >= reach {
            before = partial[lane - reach];
        }
        workgroupBarrier();
        partial[lane] += before;
        workgroupBarrier();
    }
    return partial[lane] - own;
}

@compute @workgroup_size(256)
fn blocks(
    @builtin(workgroup_id) group_id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let block = linear_group(group_id, groups);
    let first = block * BLOCK + lane * ITEMS;
    var own = array<u32, 8>();
    var sum = 0u;
    for (var k = 0u; k < ITEMS; k++) {
        own[k] = sum;
        if first + k < params.total {
            sum += values[first + k];
        }
    }
    let before = exclusive(sum, lane);
    for (var k = 0u; k < ITEMS; k++) {
        if first + k <= params.total {
            sums[first + k] = before + own[k];
        }
    }
    if lane == 0u && block < params.blocks {
        totals[block] = partial[WIDTH - 1u];
    }
}

@compute @workgroup_size(256)
fn tops(@builtin(local_invocation_index) lane: u32) {
    var carry = 0u;
    for (var start = 0u; start < params.blocks; start += WIDTH) {
        let at = start + lane;
        var own = 0u;
        if at < params.blocks {
            own = totals[at];
        }
        let before = exclusive(own, lane);
        if at < params.blocks {
            totals[at] = carry + before;
        }
        carry += partial[WIDTH - 1u];
        workgroupBarrier();
    }
}

@compute @workgroup_size(256)
fn add(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, WIDTH);
    if i <= params.total {
        sums[i] += totals[i / BLOCK];
    }
}
