// Irradiance from nine spherical harmonics (Ramamoorthi and Hanrahan 2001).

/// The first nine basis functions in a unit direction.
fn harmonics(d: vec3f) -> array<f32, 9> {
    return array<f32, 9>(
        0.282095,
        0.488603 * d.y, 0.488603 * d.z, 0.488603 * d.x,
        1.092548 * d.x * d.y, 1.092548 * d.y * d.z, 0.315392 * (3.0 * d.z * d.z - 1.0),
        1.092548 * d.x * d.z, 0.546274 * (d.x * d.x - d.y * d.y),
    );
}

/// Factor that turns radiance's coefficient into irradiance's.
fn cosine_lobe(k: u32) -> f32 {
    if k == 0u {
        return 3.141593;
    }
    return select(0.785398, 2.094395, k < 4u);
}
