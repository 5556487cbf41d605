// Meshes that blend, as far as the camera sees them directly: not through the water's surface.
#import "lib/mesh_surface.wgsl"
#import "pool/mesh_light.wgsl"

var water_z: texture_2d<f32>;
/// 1 where the eye is outside, -1 under water.
var<storage, read> eye: array<f32>;

@vertex
fn place(in: Corner) -> Vertex {
    return mesh_vertex(in);
}

@fragment
fn shade(in: Vertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    let mesh = mesh_surface(in, is_front);
    let color = mesh_color(mesh, pool_light(in.world, mesh.normal), towards_eye(in.world));
    let here = eye_z_from_depth(in.clip.z);
    let front = textureLoad(water_z, vec2i(in.clip.xy), 0).x;
    if front != 0.0 && here < front {
        discard;
    }
    let way_m = select(0.0, -here * length(eye_ray(in.clip.xy).direction), eye[0] < 0.0);
    return vec4f(color.rgb * exp(-plane_stack.absorption * way_m), color.a);
}
