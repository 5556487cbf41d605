// The corner of a mesh in the world, with its normal; the input is called `meshes`.
#import "lib/meshes.wgsl"

struct Placed {
    world: vec3f,
    normal: vec3f,
}

var<storage, read> meshes_bodies: array<mat4x4f>;
var<storage, read> meshes_instances: array<Instance>;

fn placed(position: vec3f, normal: vec3f, instance: u32) -> Placed {
    let item = meshes_instances[instance];
    let world_from_mesh = meshes_bodies[item.body] * item.body_from_mesh;
    return Placed((world_from_mesh * vec4f(position, 1.0)).xyz, transform_normal(world_from_mesh, normal));
}
