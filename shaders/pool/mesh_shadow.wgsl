// Heights of meshes as the bent sun meets them.
#import "lib/mesh_place.wgsl"
#import "lib/mesh_shadow.wgsl"

@vertex
fn place(@location(0) position: vec3f, @location(1) normal: vec3f, @location(2) instance: u32) -> @builtin(position) vec4f {
    let p = placed(position, normal, instance).world;
    let at = shadow_place(p);
    return vec4f(at.x * 2.0 - 1.0, 1.0 - 2.0 * at.y, at.z, select(1.0, 0.0, !sun_shines()));
}
