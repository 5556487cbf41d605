// What meshes offer besides their buffers' names: items of `x.instances` and `x.triangles`.

/// A primitive placed in a body: the world from it is `x_bodies[instance.body] * instance.body_from_mesh`.
struct Instance {
    body_from_mesh: mat4x4f,
    // Index into `x.bodies`.
    body: u32,
    // Its range of `x.triangles`.
    first_triangle: u32,
    triangles: u32,
    material: u32,
}

/// Indices into the vertices.
struct Triangle {
    a: u32,
    b: u32,
    c: u32,
}

/// A direction that stands on surfaces, such as a normal, through a transform that may stretch.
fn transform_normal(transform: mat4x4f, normal: vec3f) -> vec3f {
    let m = mat3x3f(transform[0].xyz, transform[1].xyz, transform[2].xyz);
    // The cofactors: the inverse transposed, but for a factor that normalising takes away, and its sign.
    let cofactors = mat3x3f(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
    return normalize(cofactors * normal * sign(dot(m[0], cofactors[0])));
}
