// Densities of grid planes, four in a texel: slabs of four planes in tiles beside and below each other. All slabs of a
// volume, or a ring of a few of which each new one takes the place of the oldest.

struct Tiles {
    columns: u32,
    rows: u32,
    // Tiles in a row, and how many there are.
    tiles: u32,
    held: u32,
    // Slabs that are in their tiles; beyond them the densities are 0.
    lowest_slab: i32,
    highest_slab: i32,
}

var<uniform> tiles_of: Tiles;
var planes: texture_2d<f32>;

/// The four densities of a slab above a texel; nothing outside the grid.
fn four_planes(texel: vec2i, slab: i32) -> vec4f {
    let size = vec2i(vec2u(tiles_of.columns, tiles_of.rows));
    if any(texel < vec2i(0)) || any(texel >= size) || slab < max(tiles_of.lowest_slab, 0) || slab > tiles_of.highest_slab {
        return vec4f(0.0);
    }
    let tile = u32(slab) % tiles_of.held;
    return textureLoad(planes, size * vec2i(vec2u(tile % tiles_of.tiles, tile / tiles_of.tiles)) + texel, 0);
}
