// Heights of meshes as the bent sun meets them.
#import "lib/mesh_holes.wgsl"
#import "lib/mesh_place.wgsl"
#import "lib/mesh_shadow.wgsl"

@vertex
fn place(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv0: vec2f,
    @location(3) uv1: vec2f,
    @location(4) color0: vec4f,
    @location(5) instance: u32,
) -> Vertex {
    let p = placed(position, normal, instance).world;
    let at = shadow_place(p);
    let clip = vec4f(at.x * 2.0 - 1.0, 1.0 - 2.0 * at.y, at.z, select(1.0, 0.0, !sun_shines()));
    return Vertex(clip, holes_uv(uv0, uv1), color0.a);
}

@fragment
fn holes(in: Vertex) {
    discard_holes(in);
}
