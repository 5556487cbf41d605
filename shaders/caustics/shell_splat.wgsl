// Sums of equation 3 (Iwasaki et al. 2006) over ellipsoids in place of surfels: normals and depths with Gaussian weights.
#import "lib/light_ellipsoid.wgsl"

struct Sums {
    @location(0) normal: vec4f,
    @location(1) path_m: f32,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn quad(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Shape {
    return shape_on_screen(instance, corner);
}

@fragment
fn weigh(in: Shape) -> Sums {
    let hit = met_by_light(in);
    if hit.away_2 > 1.0 {
        discard;
    }
    let weight = exp(-3.0 * hit.away_2);
    return Sums(weight * vec4f(hit.normal, 1.0), weight * hit.path_m, depth_of_path(hit.path_m));
}
