var<storage, read_write> count: atomic<u32>;
@compute @workgroup_size(1) fn main() { count += 1u; }
