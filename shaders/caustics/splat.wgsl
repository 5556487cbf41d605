// Sums of equation 3 (Iwasaki et al. 2006): normals and depths with Gaussian weights, and the weights.
#import "lib/light_disc.wgsl"

struct Sums {
    @location(0) normal: vec4f,
    @location(1) path_m: f32,
}

var<storage, read> surfels: Surfels;

@vertex
fn disc(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Disc {
    return disc_on_screen(surfels.items[instance], corner, 0.0);
}

@fragment
fn weigh(in: Disc) -> Sums {
    let away_2 = dot(in.side, in.side);
    if away_2 > 1.0 {
        discard;
    }
    let weight = exp(-3.0 * away_2);
    return Sums(weight * vec4f(in.normal, 1.0), weight * in.path_m);
}
