// Meshes in sun and sky light. Who imports this says with `through_water` how much of the sun's light comes through water.
#import "dry_scene/mesh_light.wgsl"
#import "lib/mesh_surface.wgsl"

/// What a fragment of a mesh sends to the eye, premultiplied.
fn lit_mesh(in: Vertex, is_front: bool) -> vec4f {
    let surface = mesh_surface(in, is_front);
    let light = dry_light(in.world, surface.normal, through_water(in.world));
    return mesh_color(surface, light, towards_eye(in.world));
}
