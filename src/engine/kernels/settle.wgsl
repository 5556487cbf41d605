// After appends: keeps the largest raw count for reporting, clamps the count to the capacity, and
// writes the arguments of those that consume the items. One thread.
struct Settle {
    capacity: u32,
    stat: u32,
    consumers: u32,
    // Whether it may run again for what it settled: then the stat is the largest of all.
    runs_again: u32,
}

struct Consumer {
    slot: u32,
    // 0: dispatch, 1: draw, 2: indexed draw.
    kind: u32,
    // Dispatch: items to a workgroup. Draw: vertices, or ALL.
    first: u32,
    // Draw: instances, or ALL.
    second: u32,
}

// Stands for the count.
const ALL = 0xffffffffu;
const WORDS_TO_A_SLOT = 8u;
const MOST_GROUPS = 65535u;

@group(0) @binding(0) var<storage, read_write> counted: array<u32>;
@group(0) @binding(1) var<storage, read_write> slots: array<u32>;
@group(0) @binding(2) var<storage, read_write> stats: array<u32>;
@group(0) @binding(3) var<uniform> settle: Settle;
@group(0) @binding(4) var<storage, read> consumers: array<Consumer>;

@compute @workgroup_size(1)
fn main() {
    let raw = counted[0];
    stats[settle.stat] = max(raw, select(0u, stats[settle.stat], settle.runs_again != 0u));
    let n = min(raw, settle.capacity);
    counted[0] = n;
    for (var i = 0u; i < settle.consumers; i++) {
        let consumer = consumers[i];
        let at = consumer.slot * WORDS_TO_A_SLOT;
        if consumer.kind == 0u {
            let groups = n / consumer.first + select(0u, 1u, n % consumer.first != 0u);
            slots[at] = min(groups, MOST_GROUPS);
            slots[at + 1u] = max((groups + MOST_GROUPS - 1u) / MOST_GROUPS, 1u);
            slots[at + 2u] = 1u;
        } else {
            slots[at] = select(consumer.first, n, consumer.first == ALL);
            slots[at + 1u] = select(consumer.second, n, consumer.second == ALL);
            slots[at + 2u] = 0u;
            slots[at + 3u] = 0u;
            slots[at + 4u] = 0u;
        }
    }
}
