// The light on meshes in and above the pool.
#import "lib/caustic_planes.wgsl"

fn pool_light(p: vec3f, normal: vec3f) -> SurfaceLight {
    // Off the surface, so that the shadow's coarse heights do not shade what casts it.
    let off_m = (light_screen.region_max.x - light_screen.region_min.x) / 150.0;
    return light_of_planes(p + off_m * normal, normal);
}
