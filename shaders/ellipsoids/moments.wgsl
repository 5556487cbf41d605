// Density and weighted mean and covariance of each particle's neighbours (Yu and Turk 2013, equations 9 to 11; Müller
// et al. 2003 for the density), in one sweep over the neighbour grid.
#import "lib/dispatch.wgsl"
#import "lib/moments.wgsl"
#import "lib/neighbours.wgsl"

struct Params {
    particles_count: u32,
    particles_radius: f32,
    support_m: f32,
    candidates_max: u32,
}

var<uniform> params: Params;
var<storage, read_write> moments: array<Moments>;

@compute @workgroup_size(64)
fn sweep(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let own = linear_index(id, groups, 64u);
    if own >= params.particles_count {
        return;
    }
    let p = sorted_position(grid_sorted[own]);
    let cell = grid_cell(p);
    let stride = stride_around(cell, params.candidates_max);

    // The particle itself counts once, at distance 0.
    var weight = 0.0;
    var first = vec3f(0.0);
    var diagonal = vec3f(0.0);
    var mixed = vec3f(0.0);
    var kernel = 0.0;
    let inverse = 1.0 / (params.support_m * params.support_m);
    for (var k = 0u; k < RUNS; k++) {
        let run = run_around(cell, k);
        for (var j = run.x; j < run.y; j += stride) {
            let offset = sorted_position(grid_sorted[j]) - p;
            let q2 = dot(offset, offset) * inverse;
            if q2 < 1.0 && j != own {
                let w = 1.0 - q2 * sqrt(q2);
                let rest = 1.0 - q2;
                kernel += rest * rest * rest;
                weight += w;
                let weighted = w * offset;
                first += weighted;
                diagonal += weighted * offset;
                mixed += weighted * offset.yzx;
            }
        }
    }
    let scale = f32(stride);
    weight = 1.0 + scale * weight;
    let mean = scale * first / weight;
    var out: Moments;
    out.mean = p + mean;
    // The smoothing kernel's constant times the volume of a particle, (2 r)^3: 1 in an undisturbed lattice.
    let volume_ratio = 2.0 * params.particles_radius / params.support_m;
    out.density = KERNEL_NORM * volume_ratio * volume_ratio * volume_ratio * (1.0 + scale * kernel);
    out.diagonal = scale * diagonal / weight - mean * mean;
    out.mixed = scale * mixed / weight - mean * mean.yzx;
    moments[grid_sorted[own].particle] = out;
}
