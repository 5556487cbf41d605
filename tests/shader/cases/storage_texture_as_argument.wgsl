var picture: texture_storage_2d<r32float, write>;
fn width(t: texture_storage_2d<r32float, write>) -> u32 { return textureDimensions(t).x; }
var<storage, read_write> out: array<u32>;
@compute @workgroup_size(1) fn main() { out[0] = width(picture); }
