// Surfels of one slab, a thread for each place that was found.
#import "lib/planes_of_slab.wgsl"
#import "lib/surfel_append.wgsl"

@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    place_surfel(linear_index(id, groups, 64u));
}
