// The corner of a mesh in the world, with its normal; the input is called `meshes`.
#import "lib/meshes.wgsl"

struct Placed {
    world: vec3f,
    normal: vec3f,
}

var<storage, read> meshes_bodies: array<mat4x4f>;
var<storage, read> meshes_instances: array<Instance>;

fn world_from_mesh(instance: u32) -> mat4x4f {
    let item = meshes_instances[instance];
    return meshes_bodies[item.body] * item.body_from_mesh;
}

fn placed(position: vec3f, normal: vec3f, instance: u32) -> Placed {
    let transform = world_from_mesh(instance);
    return Placed((transform * vec4f(position, 1.0)).xyz, transform_normal(transform, normal));
}
