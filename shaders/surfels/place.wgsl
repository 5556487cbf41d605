// Surfels at the places that were found (Iwasaki et al. 2006, section 4.2).
#import "lib/dispatch.wgsl"
#import "lib/grid_place.wgsl"
#import "lib/surfel_search.wgsl"

struct Places {
    count: u32,
    items: array<vec2u>,
}

struct Appended {
    count: atomic<u32>,
    items: array<Surfel>,
}

var<storage, read> places: Places;
var<storage, read_write> surfels: Appended;

@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 64u);
    if i >= places.count {
        return;
    }
    let at = unpack_place(places.items[i]);
    let kind = places.items[i].y;
    var found: Found;
    if kind < 3u {
        found = on_edge(at, kind);
    } else {
        found = in_face(at, kind - 3u, (kind - 2u) % 3u);
    }
    let steep = dot(found.slope, found.slope);
    if steep == 0.0 {
        return;
    }
    let to = atomicAdd(&surfels.count, 1u);
    if to < arrayLength(&surfels.items) {
        let position = params.origin + params.spacing * found.place;
        surfels.items[to] = Surfel(position, params.radius_m, -found.slope * inverseSqrt(steep));
    }
}
