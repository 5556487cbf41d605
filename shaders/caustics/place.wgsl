// Says where sample planes lie, for shaders that know nothing else of them.
#import "lib/planes_place.wgsl"

var<uniform> given: PlanesPlace;
var<storage, read_write> place: array<PlanesPlace>;

@compute @workgroup_size(1)
fn say() {
    place[0] = given;
}
