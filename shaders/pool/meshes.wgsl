// Meshes in and above the pool as the camera sees them directly.
#import "lib/mesh_surface.wgsl"
#import "pool/mesh_light.wgsl"

@vertex
fn place(in: Corner) -> Vertex {
    return mesh_vertex(in);
}

@fragment
fn shade(in: Vertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    let mesh = mesh_surface(in, is_front);
    return mesh_color(mesh, pool_light(in.world, mesh.normal), towards_eye(in.world));
}
