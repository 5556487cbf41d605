// Meshes in sun and sky light, the sun's faded by the water.
#import "dry_scene/mesh_surface.wgsl"
#import "dry_scene/through_thickness.wgsl"

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
    return mesh_color(in, is_front, through_water(in.world));
}
