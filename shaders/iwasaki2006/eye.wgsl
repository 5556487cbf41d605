// Whether the eye is under water: the density of equation 1 (Iwasaki et al. 2006) at one point, over the clusters within
// reach. Not in the paper, whose camera stays outside.
#import "lib/camera.wgsl"
#import "lib/kernel.wgsl"
#import "lib/mirrors.wgsl"
#import "lib/packed.wgsl"

const THREADS = 256u;

struct Params {
    water_low: vec3f,
    water_reach_m: f32,
    water_peak: f32,
    water_iso_level: f32,
    water_cluster_m: f32,
    water_clusters: u32,
}

var<uniform> params: Params;
var<storage, read> water_sorted: array<Packed3>;
var<storage, read> water_cluster_start: array<u32>;
/// 1 outside, -1 inside.
var<storage, read_write> eye: array<f32>;

var<workgroup> partial: array<f32, 256>;

fn cluster_at(y: f32) -> u32 {
    return u32(clamp((y - params.water_low.y) / params.water_cluster_m, 0.0, f32(params.water_clusters - 1u)));
}

@compute @workgroup_size(256)
fn look(@builtin(local_invocation_index) lane: u32) {
    let p = camera.position;
    let end = water_cluster_start[cluster_at(p.y + params.water_reach_m) + 1u];
    var sum = 0.0;
    for (var i = water_cluster_start[cluster_at(p.y - params.water_reach_m)] + lane; i < end; i += THREADS) {
        let center = unpack3(water_sorted[i]);
        let own = (center - p) / params.water_reach_m;
        let image = (mirrored(center) - p) / params.water_reach_m;
        for (var k = 0u; k < 8u; k++) {
            let away = select(own, image, (vec3u(k) >> vec3u(0u, 1u, 2u) & vec3u(1u)) == vec3u(1u));
            sum += bracket(dot(away, away));
        }
    }
    partial[lane] = sum;
    workgroupBarrier();
    if lane == 0u {
        var density = 0.0;
        for (var other = 0u; other < THREADS; other++) {
            density += partial[other];
        }
        let inside = params.water_iso_level > 0.0 && params.water_peak * density >= params.water_iso_level;
        eye[0] = select(1.0, -1.0, inside);
    }
}
