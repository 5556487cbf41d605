// Places of the whole volume where surfels are.
#import "lib/planes_in_atlas.wgsl"
#import "lib/surfel_places.wgsl"

@compute @workgroup_size(8, 8)
fn find_places(@builtin(global_invocation_id) id: vec3u) {
    if all(id < vec3u(layout_of.columns, layout_of.rows, layout_of.slabs)) {
        find(vec2i(id.xy), i32(id.z));
    }
}
