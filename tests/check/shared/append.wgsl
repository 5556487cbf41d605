// Appends a number.
struct Found {
    count: atomic<u32>,
    items: array<u32>,
}
var<storage, read_write> found: Found;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let at = atomicAdd(&found.count, 1u);
    if at < arrayLength(&found.items) {
        found.items[at] = id.x;
    }
}
