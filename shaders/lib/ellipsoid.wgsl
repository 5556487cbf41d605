// An ellipsoid in world space: centre and the three half-axes as vectors at right angles (48 bytes).

struct Ellipsoid {
    axis_x: vec3f,
    centre_x: f32,
    axis_y: vec3f,
    centre_y: f32,
    axis_z: vec3f,
    centre_z: f32,
}

fn ellipsoid_of(centre: vec3f, axes: mat3x3f) -> Ellipsoid {
    return Ellipsoid(axes[0], centre.x, axes[1], centre.y, axes[2], centre.z);
}

fn ellipsoid_centre(e: Ellipsoid) -> vec3f {
    return vec3f(e.centre_x, e.centre_y, e.centre_z);
}

fn ellipsoid_axes(e: Ellipsoid) -> mat3x3f {
    return mat3x3f(e.axis_x, e.axis_y, e.axis_z);
}
