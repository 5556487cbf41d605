// Meshes that blend, before or behind the liquid, in sun and sky light, the sun's faded by the water.
#import "blended/liquid.wgsl"
#import "dry_scene/mesh_light.wgsl"
#import "dry_scene/through_thickness.wgsl"
#import "lib/mesh_surface.wgsl"

@vertex
fn place(in: Corner) -> Vertex {
    return mesh_vertex(in);
}

@fragment
fn shade(in: Vertex, @builtin(front_facing) is_front: bool) -> Shown {
    let surface = mesh_surface(in, is_front);
    let light = dry_light(in.world, surface.normal, through_water(in.world));
    return in_liquid(mesh_color(surface, light, towards_eye(in.world)), in.clip);
}
