// Twice each number.
var<storage> numbers: array<u32>;
var<storage, read_write> twice: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&twice) {
        twice[id.x] = 2u * numbers[id.x];
    }
}
