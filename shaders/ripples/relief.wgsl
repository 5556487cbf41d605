// The surface as others read it: height, slopes by central differences, and curvature.
#import "ripples/surface.wgsl"

struct Params {
    cell_m: f32,
}

var<uniform> params: Params;
var relief: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn slopes(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2i(textureDimensions(relief));
    let texel = vec2i(id.xy);
    if any(texel >= size) {
        return;
    }
    let last = size - 1;
    let middle = height(texel, last);
    let east = height(texel + vec2i(1, 0), last);
    let west = height(texel - vec2i(1, 0), last);
    let south = height(texel + vec2i(0, 1), last);
    let north = height(texel - vec2i(0, 1), last);
    let slope = vec2f(east - west, south - north) / (2.0 * params.cell_m);
    let curvature = (east + west + south + north - 4.0 * middle) / (params.cell_m * params.cell_m);
    textureStore(relief, texel, vec4f(middle, slope, curvature));
}
