// Meshes in sun and sky light, behind some water or none.
#import "dry_scene/mesh_light.wgsl"
#import "lib/mesh_surface.wgsl"

/// What a fragment of a mesh sends to the eye, premultiplied; `through` is the share of the sun's light that water lets
/// pass.
fn lit_mesh(in: Vertex, is_front: bool, through: vec3f) -> vec4f {
    let surface = mesh_surface(in, is_front);
    return mesh_color(surface, dry_light(in.world, surface.normal, through), towards_eye(in.world));
}
