var<storage> items: array<f32>;
@compute @workgroup_size(64) fn main() { items[0] = 1.0; }
