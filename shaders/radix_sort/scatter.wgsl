// Radix sort, second half of a pass: each pair to its place; equal digits keep their order (the sort is stable).
#import "lib/dispatch.wgsl"
#import "lib/radix.wgsl"

struct Params {
    total: u32,
    tiles: u32,
    place: u32,
}

var<uniform> params: Params;
var<storage, read> pairs: array<vec2u>;
var<storage, read> scan_sums: array<u32>;
var<storage, read_write> pairs_next: array<vec2u>;

@compute @workgroup_size(64)
fn scatter(
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
    // From here a counter is the place of its thread's next pair with that digit.
    if thread < RADIX_DIGITS && tile < params.tiles {
        var next = scan_sums[thread * params.tiles + tile];
        for (var other = 0u; other < RADIX_THREADS; other++) {
            let own = counters[thread * RADIX_THREADS + other];
            counters[thread * RADIX_THREADS + other] = next;
            next += own;
        }
    }
    workgroupBarrier();
    for (var i = first; i < end; i++) {
        let at = radix_digit(pairs[i].x, params.place) * RADIX_THREADS + thread;
        pairs_next[counters[at]] = pairs[i];
        counters[at] += 1u;
    }
}
