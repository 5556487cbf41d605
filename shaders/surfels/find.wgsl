// Finds where surfels are: the edges of the grid that the surface crosses, and the faces with two crossings (Iwasaki et
// al. 2006, section 4.2). A thread looks at the grid points of a slab above one texel.
#import "lib/density_planes.wgsl"
#import "lib/grid_place.wgsl"
#import "lib/mirrors.wgsl"

struct Params {
    iso_level: f32,
    columns: u32,
    rows: u32,
    first_slab: i32,
    origin: vec3f,
    spacing: f32,
}

struct Places {
    count: atomic<u32>,
    items: array<vec2u>,
}

var<uniform> params: Params;
var<storage, read_write> places: Places;

fn append(at: vec3i, kind: u32) {
    let i = atomicAdd(&places.count, 1u);
    if i < arrayLength(&places.items) {
        places.items[i] = pack_place(at, kind);
    }
}

/// Which of five planes' points lie inside: those of a slab, and the lowest of the next.
fn sides(texel: vec2i, slab: i32) -> u32 {
    let here = vec4u(four_planes(texel, slab) >= vec4f(params.iso_level));
    let above = u32(four_planes(texel, slab + 1).x >= params.iso_level);
    return here.x | (here.y << 1u) | (here.z << 2u) | (here.w << 3u) | (above << 4u);
}

@compute @workgroup_size(8, 8)
fn find(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= vec2u(params.columns, params.rows)) {
        return;
    }
    let texel = vec2i(id.xy);
    let slab = params.first_slab + i32(id.z);
    let here = sides(texel, slab);
    let right = sides(texel + vec2i(1, 0), slab);
    let down = sides(texel + vec2i(0, 1), slab);
    let across = sides(texel + vec2i(1, 1), slab);
    if (here | right | down | across) == 0u || (here & right & down & across) == 31u {
        return;
    }
    // A bit for each plane: which edges are crossed along x, y and z.
    let along_x = here ^ right;
    let along_y = here ^ (here >> 1u);
    let along_z = here ^ down;
    // Faces from x and y, y and z, z and x, by their four edges.
    let faces = array<vec4u, 3>(
        vec4u(along_x, along_x >> 1u, along_y, right ^ (right >> 1u)),
        vec4u(along_y, down ^ (down >> 1u), along_z, along_z >> 1u),
        vec4u(along_z, right ^ across, along_x, down ^ across),
    );
    for (var k = 0u; k < 4u; k++) {
        let at = vec3i(texel.x, 4 * slab + i32(k), texel.y);
        // Nobody sees what is behind floor and walls, but discs shall reach them.
        if !before_mirrors(params.origin + params.spacing * vec3f(at), 1.5 * params.spacing) {
            continue;
        }
        let crossed = (vec3u(along_x, along_y, along_z) >> vec3u(k)) & vec3u(1u);
        for (var axis = 0u; axis < 3u; axis++) {
            if crossed[axis] == 1u {
                append(at, axis);
            }
            if dot((faces[axis] >> vec4u(k)) & vec4u(1u), vec4u(1u)) == 2u {
                append(at, 3u + axis);
            }
        }
    }
}
