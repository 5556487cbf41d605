// Nothing measured yet: every triangle is nearer, and the surface winds around no cell.
#import "lib/dispatch.wgsl"

var<storage, read_write> nearest: array<f32>;
var<storage, read_write> winding: array<f32>;

@compute @workgroup_size(64)
fn begin(@builtin(global_invocation_id) global_id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let cell = linear_index(global_id, groups, 64u);
    if cell < arrayLength(&nearest) {
        nearest[cell] = 1e30;
        winding[cell] = 0.0;
    }
}
