// Densities from an atlas of slabs of four grid planes each.

struct Tiles {
    columns: u32,
    rows: u32,
    slabs: u32,
    tiles: u32,
}

var<uniform> layout_of: Tiles;
var atlas: texture_2d<f32>;

fn four_planes(texel: vec2i, slab: i32) -> vec4f {
    let size = vec2i(vec2u(layout_of.columns, layout_of.rows));
    let tiles = i32(layout_of.tiles);
    if any(texel < vec2i(0)) || any(texel >= size) || slab < 0 || slab >= i32(layout_of.slabs) {
        return vec4f(0.0);
    }
    return textureLoad(atlas, size * vec2i(slab % tiles, slab / tiles) + texel, 0);
}
