// Each key with its place in the input, before the first pass of the radix sort.
#import "lib/dispatch.wgsl"

struct Params {
    total: u32,
}

var<uniform> params: Params;
var<storage, read> keys: array<u32>;
var<storage, read_write> pairs: array<vec2u>;

@compute @workgroup_size(256)
fn pair(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 256u);
    if i < params.total {
        pairs[i] = vec2u(keys[i], i);
    }
}
