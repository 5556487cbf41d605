// Radix sort, first half of a pass: how often each digit occurs in each tile, digit by digit.
#import "lib/dispatch.wgsl"
#import "lib/radix.wgsl"

struct Params {
    total: u32,
    tiles: u32,
    place: u32,
}

var<uniform> params: Params;
var<storage, read> pairs: array<vec2u>;
var<storage, read_write> tile_counts: array<u32>;

@compute @workgroup_size(64)
fn count(
    @builtin(workgroup_id) group_id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let tile = linear_group(group_id, groups);
    clear_counters(thread);
    let first = tile * RADIX_TILE + thread * RADIX_ITEMS;
    let end = min(first + RADIX_ITEMS, params.total);
    for (var i = first; i < end; i++) {
        counters[radix_digit(pairs[i].x, params.place) * RADIX_THREADS + thread] += 1u;
    }
    workgroupBarrier();
    if thread < RADIX_DIGITS && tile < params.tiles {
        var sum = 0u;
        for (var other = 0u; other < RADIX_THREADS; other++) {
            sum += counters[thread * RADIX_THREADS + other];
        }
        tile_counts[thread * params.tiles + tile] = sum;
    }
}
