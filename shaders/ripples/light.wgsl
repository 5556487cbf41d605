// Sunlight on the floor: a net over the surface, each corner carried to the floor along the refracted sun ray. Where the
// net is drawn together the floor is brighter, by as much as its area shrank.
#import "lib/light.wgsl"
#import "lib/optics.wgsl"

struct Params {
    cell_m: f32,
    pool: vec3f,
    net: vec2u,
    ior: f32,
}

struct Vertex {
    @builtin(position) clip: vec4f,
    /// Where the light entered, in texels of the floor's picture.
    @location(0) entered: vec2f,
}

var<uniform> params: Params;
var<uniform> sun: Light;
var relief: texture_2d<f32>;

@vertex
fn carried(@builtin(vertex_index) index: u32) -> Vertex {
    let quad = index / 6u;
    let corner = index % 6u;
    let right = corner == 1u || corner == 2u || corner == 4u;
    let far = corner == 2u || corner == 4u || corner == 5u;
    let node = vec2u(quad % params.net.x, quad / params.net.x) + select(vec2u(0u), vec2u(1u), vec2<bool>(right, far));
    let size = vec2f(textureDimensions(relief));
    // The outermost corners lie on the walls, all others on cells.
    let is_last = node == params.net;
    let texel = select(vec2f(2u * node) + 0.5, size, is_last) - select(vec2f(0.0), vec2f(0.5), node == vec2u(0u));
    let here = textureLoad(relief, min(vec2i(texel), vec2i(size) - 1), 0);
    let normal = normalize(vec3f(-here.y, 1.0, -here.z));
    let ray = bend_in(sun.direction, normal, params.ior).direction;
    let still = bend_in(sun.direction, vec3f(0.0, 1.0, 0.0), params.ior).direction;
    let way = (params.pool.y + here.x) / max(-ray.y, 0.05);
    let on_floor = texel + way * ray.xz / params.cell_m;
    // In the floor's texels, of which there are two to a cell.
    let unmoved = texel + params.pool.y * still.xz / max(-still.y, 0.05) / params.cell_m;
    let ndc = on_floor / size * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    return Vertex(vec4f(ndc, 0.5, 1.0), 2.0 * unmoved);
}

@fragment
fn gathered(in: Vertex) -> @location(0) f32 {
    let x = dpdx(in.entered);
    let y = dpdy(in.entered);
    // A fold squeezes a finite net to nothing; the sun's disc keeps real light from it.
    return min(abs(x.x * y.y - x.y * y.x), 12.0);
}
