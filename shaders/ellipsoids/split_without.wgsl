// Numbers of the body's and of the splashes' particles, each in ascending order, without the strays, from the prefix
// sums of body and strays.
#import "lib/dispatch.wgsl"

struct Ids {
    count: u32,
    items: array<u32>,
}

struct Params {
    particles_count: u32,
}

var<uniform> params: Params;
var<storage, read> rank_sums: array<u32>;
var<storage, read> gone_sums: array<u32>;
var<storage, read_write> body: Ids;
var<storage, read_write> splash: Ids;

@compute @workgroup_size(256)
fn split(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 256u);
    if i > params.particles_count {
        return;
    }
    let before = rank_sums[i];
    let gone = gone_sums[i];
    if i == params.particles_count {
        body.count = before;
        splash.count = i - before - gone;
    } else if rank_sums[i + 1u] > before {
        body.items[before] = i;
    } else if gone_sums[i + 1u] == gone {
        splash.items[i - before - gone] = i;
    }
}
