// Meshes that blend, before or behind the liquid, in sun and sky light, the sun's faded by the water.
#import "blended/liquid.wgsl"
#import "dry_scene/lit_mesh.wgsl"
#import "dry_scene/through_thickness.wgsl"

@vertex
fn place(in: Corner) -> Vertex {
    return mesh_vertex(in);
}

@fragment
fn shade(in: Vertex, @builtin(front_facing) is_front: bool) -> Shown {
    return in_liquid(lit_mesh(in, is_front, through_water(in.world)), in.clip);
}
