// The light on meshes of the dry scene.
#import "dry_scene/skylight.wgsl"
#import "dry_scene/sunlight.wgsl"
#import "lib/surface_light.wgsl"

/// `through` is the share of the sun's light that water lets pass.
fn dry_light(p: vec3f, normal: vec3f, through: vec3f) -> SurfaceLight {
    return SurfaceLight(sky_irradiance(normal), vec3f(1.0), from_sun(p, normal, through), -sun.direction);
}
