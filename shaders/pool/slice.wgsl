// A sliced object image: colour of the meshes between sample planes `slice` and `slice` + 1, lit by their caustics, and
// the height of what is seen (Iwasaki et al. 2006, section 5.2).
#import "lib/mesh_color.wgsl"
#import "lib/mesh_place.wgsl"
#import "lib/slices.wgsl"

struct Params {
    slice: u32,
    planes: u32,
    camera_position: vec3f,
}

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
}

struct Image {
    @location(0) color: vec4f,
    @location(1) height: f32,
}

var<uniform> params: Params;

@vertex
fn place(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv0: vec2f,
    @location(3) color0: vec4f,
    @location(4) instance: u32,
) -> Vertex {
    let at = placed(position, normal, instance);
    let upper = plane_height(params.slice, params.planes);
    let lower = plane_height(params.slice + 1u, params.planes);
    let uv = slice_uv(at.world, slice_view(params.camera_position), upper);
    // Reversed depth is the height within the slice, which overlaps its neighbours so that no ray slips between them;
    // what is above or below is cut off.
    let spare = 0.15 * (upper - lower);
    let depth = (at.world.y - lower + spare) / (upper - lower + 2.0 * spare);
    return Vertex(vec4f(uv.x * 2.0 - 1.0, 1.0 - 2.0 * uv.y, depth, 1.0), at.world, at.normal, uv0, color0);
}

@fragment
fn shade(in: Vertex) -> Image {
    let faces = dot(in.normal, slice_view(params.camera_position)) < 0.0;
    let color = mesh_color(in.world, in.normal, in.uv, in.color, faces);
    if color.a == 0.0 {
        discard;
    }
    return Image(color, in.world.y);
}
