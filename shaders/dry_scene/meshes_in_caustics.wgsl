// Meshes in sun and sky light, the sun's bent by the water.
#import "dry_scene/mesh_light.wgsl"
#import "dry_scene/through_caustics.wgsl"
#import "lib/mesh_surface.wgsl"

@vertex
fn place(in: Corner) -> Vertex {
    return mesh_vertex(in);
}

@fragment
fn shade(in: Vertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    let surface = mesh_surface(in, is_front);
    return mesh_color(surface, dry_light(in.world, surface.normal, through_water(in.world)), towards_eye(in.world));
}
