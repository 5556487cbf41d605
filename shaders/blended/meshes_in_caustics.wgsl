// Meshes that blend, before or behind the liquid, in sun and sky light, the sun's bent by the water.
#import "blended/liquid.wgsl"
#import "dry_scene/mesh_light.wgsl"
#import "dry_scene/through_caustics.wgsl"
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
fn shade(in: Vertex, @builtin(front_facing) is_front: bool) -> Shown {
    let surface = mesh_surface(in, is_front);
    let light = dry_light(in.world, surface.normal, through_water(in.world));
    return in_liquid(mesh_color(surface, light, towards_eye(in.world)), in.clip);
}
