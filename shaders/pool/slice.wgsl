// A sliced object image: colour of the meshes between sample planes `slice` and `slice` + 1, lit by their caustics, and
// the height of what is seen (Iwasaki et al. 2006, section 5.2).
#import "lib/mesh_surface.wgsl"
#import "lib/slices.wgsl"
#import "pool/mesh_light.wgsl"

struct Params {
    slice: u32,
    planes: u32,
    camera_position: vec3f,
}

struct Image {
    @location(0) color: vec4f,
    @location(1) height: f32,
}

var<uniform> params: Params;

@vertex
fn place(in: Corner) -> Vertex {
    let at = placed(in.position, in.normal, in.instance);
    let upper = plane_height(params.slice, params.planes);
    let lower = plane_height(params.slice + 1u, params.planes);
    let at_uv = slice_uv(at.world, slice_view(params.camera_position), upper);
    // Reversed depth is the height within the slice, which overlaps its neighbours so that no ray slips between them;
    // what is above or below is cut off.
    let spare = 0.15 * (upper - lower);
    let depth = (at.world.y - lower + spare) / (upper - lower + 2.0 * spare);
    var out = mesh_corner(at, in);
    out.clip = vec4f(at_uv.x * 2.0 - 1.0, 1.0 - 2.0 * at_uv.y, depth, 1.0);
    return out;
}

@fragment
fn shade(in: Vertex, @builtin(front_facing) is_front: bool) -> Image {
    let mesh = mesh_surface(in, is_front);
    let color = mesh_color(mesh, pool_light(in.world, mesh.normal), -slice_view(params.camera_position));
    return Image(color, in.world.y);
}
