// Sets every word of a buffer.
struct Fill {
    word: u32,
    words: u32,
    // Threads to a row of workgroups.
    row: u32,
    unused: u32,
}

@group(0) @binding(0) var<storage, read_write> words: array<u32>;
@group(0) @binding(1) var<uniform> fill: Fill;

@compute @workgroup_size(256)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = id.y * fill.row + id.x;
    if at < fill.words {
        words[at] = fill.word;
    }
}
