// Densities of one slab of four grid planes, with the slabs below and above it.

struct Slab {
    columns: u32,
    rows: u32,
    // The slab in `here`; -1 before the first.
    slab_below: i32,
}

var<uniform> slab_of: Slab;
var below: texture_2d<f32>;
var here: texture_2d<f32>;
var above: texture_2d<f32>;

fn four_planes(texel: vec2i, slab: i32) -> vec4f {
    if any(texel < vec2i(0)) || any(texel >= vec2i(vec2u(slab_of.columns, slab_of.rows))) {
        return vec4f(0.0);
    }
    let beside = slab - slab_of.slab_below;
    if beside == 0 {
        return textureLoad(here, texel, 0);
    }
    if beside == 1 {
        return textureLoad(above, texel, 0);
    }
    return textureLoad(below, texel, 0);
}
