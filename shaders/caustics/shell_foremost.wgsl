// Depth of the ellipsoids that the light meets first, moved away from it by epsilon.
#import "lib/light_ellipsoid.wgsl"

struct Params {
    epsilon: f32,
}

var<uniform> params: Params;

@vertex
fn quad(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Shape {
    return shape_on_screen(instance, corner);
}

@fragment
fn nearest(in: Shape) -> @builtin(frag_depth) f32 {
    let hit = met_by_light(in);
    if hit.away_2 > 1.0 {
        discard;
    }
    return depth_of_path(hit.path_m + params.epsilon);
}
