// Front or back surface of a list of ellipsoids: eye z, normal and depth (Imai 2016, section 4.2).
#import "lib/camera.wgsl"
#import "lib/ellipsoid.wgsl"
#import "lib/impostor.wgsl"

override back: bool;

struct Ids {
    count: u32,
    items: array<u32>,
}

struct Surface {
    @location(0) z: f32,
    @location(1) normal: vec4f,
    @builtin(frag_depth) depth: f32,
}

var<storage, read> ids: Ids;
var<storage, read> ellipsoid: array<Ellipsoid>;

@vertex
fn quad(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Impostor {
    let shape = ellipsoid[ids.items[instance]];
    let axes = ellipsoid_axes(shape);
    let axes_in_view = mat3x3f(
        (camera.view_from_world * vec4f(axes[0], 0.0)).xyz,
        (camera.view_from_world * vec4f(axes[1], 0.0)).xyz,
        (camera.view_from_world * vec4f(axes[2], 0.0)).xyz,
    );
    return impostor(corner, eye_from_world_point(ellipsoid_centre(shape)), axes_in_view);
}

@fragment
fn surface(in: Impostor) -> Surface {
    let hit = impostor_hit(in, back);
    if !hit.hit {
        discard;
    }
    return Surface(hit.z, vec4f(hit.normal, 0.0), depth_from_eye_z(hit.z));
}
