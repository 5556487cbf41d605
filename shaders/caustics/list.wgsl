// The quads between beams, cell after cell: a whole one, or one for each of its pixels.
#import "lib/dispatch.wgsl"

struct Quads {
    count: u32,
    // The first corner's pixel in x and y, and pixels along an edge.
    items: array<vec2u>,
}

struct Params {
    split: u32,
    screen_px: vec2f,
}

var<uniform> params: Params;
var<storage, read> rank_sums: array<u32>;
var<storage, read_write> quads: Quads;

@compute @workgroup_size(64)
fn list(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let cell = linear_index(id, groups, 64u);
    let cells = vec2u(params.screen_px - 1.0) / params.split;
    if cell > cells.x * cells.y {
        return;
    }
    let before = rank_sums[cell];
    if cell == cells.x * cells.y {
        quads.count = before;
        return;
    }
    let first = vec2u(cell % cells.x, cell / cells.x) * params.split;
    let parts = rank_sums[cell + 1u] - before;
    for (var k = 0u; k < parts; k++) {
        let pixel = first + vec2u(k % params.split, k / params.split);
        quads.items[before + k] = vec2u(pixel.x | (pixel.y << 16u), select(1u, params.split, parts == 1u));
    }
}
