// Meshes in sun and sky light, the sun's faded by the water.
#import "dry_scene/lit_mesh.wgsl"
#import "dry_scene/through_thickness.wgsl"

@vertex
fn place(in: Corner) -> Vertex {
    return mesh_vertex(in);
}

@fragment
fn shade(in: Vertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    return lit_mesh(in, is_front, through_water(in.world));
}
