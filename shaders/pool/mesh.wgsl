// Meshes in and above the pool as the camera sees them directly.
#import "lib/camera.wgsl"
#import "lib/mesh_color.wgsl"
#import "lib/mesh_place.wgsl"

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
}

@vertex
fn place(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv0: vec2f,
    @location(3) color0: vec4f,
    @location(4) instance: u32,
) -> Vertex {
    let at = placed(position, normal, instance);
    return Vertex(camera.clip_from_world * vec4f(at.world, 1.0), at.world, at.normal, uv0, color0);
}

@fragment
fn shade(in: Vertex, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let color = mesh_color(in.world, in.normal, in.uv, in.color, front);
    if color.a == 0.0 {
        discard;
    }
    return color;
}
