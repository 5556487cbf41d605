// Surfels at the places that were found. Who imports this gives `four_planes`, as for `lib/surfel_search.wgsl`.
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

fn place_surfel(i: u32) {
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
