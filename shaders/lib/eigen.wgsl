// Eigenvalues and eigenvectors of a symmetric 3 x 3 matrix by Jacobi rotations.

struct Eigen {
    values: vec3f,
    // Unit vectors at right angles, in the order of the values.
    vectors: mat3x3f,
}

/// Cosine and sine of the rotation that clears the element pq, and its tangent.
fn jacobi_rotation(pp: f32, qq: f32, pq: f32) -> vec3f {
    if pq == 0.0 {
        return vec3f(1.0, 0.0, 0.0);
    }
    let theta = (qq - pp) / (2.0 * pq);
    let tangent = select(-1.0, 1.0, theta >= 0.0) / (abs(theta) + sqrt(theta * theta + 1.0));
    let cosine = inverseSqrt(tangent * tangent + 1.0);
    return vec3f(cosine, cosine * tangent, tangent);
}

/// `diagonal` holds xx, yy, zz and `mixed` holds xy, yz, zx. Five sweeps bring 32-bit floats to rest.
fn eigen_symmetric(diagonal: vec3f, mixed: vec3f) -> Eigen {
    let size = max(max(diagonal.x, max(diagonal.y, diagonal.z)), 1.0e-30);
    var d = diagonal / size;
    var xy = mixed.x / size;
    var yz = mixed.y / size;
    var zx = mixed.z / size;
    var x = vec3f(1.0, 0.0, 0.0);
    var y = vec3f(0.0, 1.0, 0.0);
    var z = vec3f(0.0, 0.0, 1.0);
    for (var k = 0; k < 5; k++) {
        let a = jacobi_rotation(d.x, d.y, xy);
        d = vec3f(d.x - a.z * xy, d.y + a.z * xy, d.z);
        xy = 0.0;
        let zx_a = a.x * zx - a.y * yz;
        yz = a.y * zx + a.x * yz;
        zx = zx_a;
        let x_a = a.x * x - a.y * y;
        y = a.y * x + a.x * y;
        x = x_a;

        let b = jacobi_rotation(d.y, d.z, yz);
        d = vec3f(d.x, d.y - b.z * yz, d.z + b.z * yz);
        yz = 0.0;
        let xy_b = b.x * xy - b.y * zx;
        zx = b.y * xy + b.x * zx;
        xy = xy_b;
        let y_b = b.x * y - b.y * z;
        z = b.y * y + b.x * z;
        y = y_b;

        let c = jacobi_rotation(d.x, d.z, zx);
        d = vec3f(d.x - c.z * zx, d.y, d.z + c.z * zx);
        zx = 0.0;
        let xy_c = c.x * xy - c.y * yz;
        yz = c.y * xy + c.x * yz;
        xy = xy_c;
        let x_c = c.x * x - c.y * z;
        z = c.y * x + c.x * z;
        x = x_c;
    }
    return Eigen(d * size, mat3x3f(x, y, z));
}
