// Front or back surface of all particles as spheres: eye z, normal and depth (Imai 2014, depth generation).
#import "lib/camera.wgsl"
#import "lib/impostor.wgsl"
#import "lib/packed.wgsl"

override back: bool;

struct Params {
    radius: f32,
}

struct Surface {
    @location(0) z: f32,
    @location(1) normal: vec4f,
    @builtin(frag_depth) depth: f32,
}

var<uniform> params: Params;
var<storage, read> particles_position: array<Packed3>;

// 1 for particles that are left out.
var<storage, read> stray: array<u32>;

@vertex
fn every(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Impostor {
    return quad(corner, instance);
}

@vertex
fn kept(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Impostor {
    var out = quad(corner, instance);
    if stray[instance] != 0u {
        out.position = vec4f(2.0, 2.0, 0.5, 1.0);
    }
    return out;
}

fn quad(corner: u32, instance: u32) -> Impostor {
    let centre = eye_from_world_point(unpack3(particles_position[instance]));
    let axes = mat3x3f(vec3f(params.radius, 0.0, 0.0), vec3f(0.0, params.radius, 0.0), vec3f(0.0, 0.0, params.radius));
    return impostor(corner, centre, axes);
}

@fragment
fn surface(in: Impostor) -> Surface {
    let hit = impostor_hit(in, back);
    if !hit.hit {
        discard;
    }
    return Surface(hit.z, vec4f(hit.normal, 0.0), depth_from_eye_z(hit.z));
}
