// How much of the sun's light comes through the water, which bends it: caustics.
#import "lib/sample_planes.wgsl"
#import "lib/sun.wgsl"

/// The light of the sample planes as a share of what would come without water.
fn through_water(p: vec3f) -> vec3f {
    let light = between_planes(p);
    let plain = irradiance(sun) * max(-sun.direction.y, 0.02);
    return select(vec3f(1.0), light.rgb / max(plain, vec3f(1.0e-6)), light.w > 0.0);
}
