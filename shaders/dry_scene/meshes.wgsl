// Meshes in sun and sky light, the sun's faded by the water.
#import "dry_scene/mesh_light.wgsl"
#import "dry_scene/through_thickness.wgsl"
#import "lib/mesh_surface.wgsl"

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
    let surface = mesh_surface(in, is_front);
    return mesh_color(surface, dry_light(in.world, surface.normal, through_water(in.world)), towards_eye(in.world));
}
