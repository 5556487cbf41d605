// Places of one slab where surfels are.
#import "lib/planes_of_slab.wgsl"
#import "lib/surfel_places.wgsl"

@compute @workgroup_size(8, 8)
fn find_places(@builtin(global_invocation_id) id: vec3u) {
    if all(id.xy < vec2u(slab_of.columns, slab_of.rows)) {
        find(vec2i(id.xy), slab_of.slab_below);
    }
}
