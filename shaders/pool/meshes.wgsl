// Meshes in and above the pool as the camera sees them directly.
#import "lib/mesh_surface.wgsl"
#import "pool/mesh_light.wgsl"

@vertex
fn place(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv0: vec2f,
    @location(4) uv1: vec2f,
    @location(5) color0: vec4f,
    @location(6) instance: u32,
) -> Vertex {
    return mesh_vertex(position, normal, tangent, uv0, uv1, color0, instance);
}

@fragment
fn shade(in: Vertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    let mesh = mesh_surface(in, is_front);
    return mesh_color(mesh, pool_light(in.world, mesh.normal), towards_eye(in.world));
}
