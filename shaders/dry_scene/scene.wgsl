// Floor and box in sun and sky light, the sun's faded by the water.
#import "dry_scene/scene_surface.wgsl"
#import "dry_scene/through_thickness.wgsl"

@vertex
fn geometry(@builtin(vertex_index) index: u32) -> Vertex {
    return dry_corner(index);
}

@fragment
fn shade(in: Vertex) -> @location(0) vec4f {
    return dry_color(in, through_water(in.world));
}
