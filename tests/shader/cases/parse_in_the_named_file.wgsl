// A semicolon is missing.
var<storage, read_write> out: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let value = 1.0
    out[id.x] = value;
}
