// Splash or body by density (Imai 2016, section 4.1), and each particle's ellipsoid: spheres for splashes, clamped
// principal axes for the body (Yu and Turk 2013, equations 6, 13 to 15; Imai 2016, section 4.2: at most 1.2 r).
#import "lib/dispatch.wgsl"
#import "lib/eigen.wgsl"
#import "lib/ellipsoid.wgsl"
#import "lib/moments.wgsl"
#import "lib/packed.wgsl"

struct Params {
    particles_count: u32,
    particles_radius: f32,
    support_m: f32,
    splash_below: f32,
    splash_size: f32,
    body_size: f32,
    stretch_max: f32,
    ratio_max: f32,
    smoothing: f32,
}

var<uniform> params: Params;
var<storage, read> particles_position: array<Packed3>;
var<storage, read> moments: array<Moments>;
var<storage, read_write> ellipsoid: array<Ellipsoid>;
var<storage, read_write> is_body: array<u32>;

@compute @workgroup_size(64)
fn shape(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 64u);
    if i >= params.particles_count {
        return;
    }
    let p = unpack3(particles_position[i]);
    let around = moments[i];
    if around.density < params.splash_below {
        let r = params.splash_size * params.particles_radius;
        ellipsoid[i] = ellipsoid_of(p, mat3x3f(vec3f(r, 0.0, 0.0), vec3f(0.0, r, 0.0), vec3f(0.0, 0.0, r)));
        is_body[i] = 0u;
        return;
    }
    let eigen = eigen_symmetric(around.diagonal, around.mixed);
    // Variances as shares of what a full neighbourhood has, so that the inside of the body gets spheres of body_size.
    let spread = eigen.values / (FULL_VARIANCE * params.support_m * params.support_m);
    let largest = max(spread.x, max(spread.y, spread.z));
    let clamped = max(spread, vec3f(largest / params.ratio_max));
    // Particles heaped on one point have no spread; a ball of a hundredth of the radius still has a projection.
    let size = clamp(params.body_size * clamped, vec3f(0.01), vec3f(params.stretch_max)) * params.particles_radius;
    let centre = mix(p, around.mean, params.smoothing);
    let axes = mat3x3f(eigen.vectors[0] * size.x, eigen.vectors[1] * size.y, eigen.vectors[2] * size.z);
    ellipsoid[i] = ellipsoid_of(centre, axes);
    is_body[i] = 1u;
}
