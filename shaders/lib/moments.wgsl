// What a particle's neighbours say: density as a share of the rest density, weighted mean, covariance about it.

struct Moments {
    // World space, m.
    mean: vec3f,
    density: f32,
    // Covariance, m²: xx, yy, zz.
    diagonal: vec3f,
    // Covariance, m²: xy, yz, zx.
    mixed: vec3f,
}

/// 315 / (64 pi), the constant of the kernel (1 - q²)³ of Müller et al. 2003.
const KERNEL_NORM = 1.5666814710608448;

/// Variance along an axis amid a full neighbourhood, in squares of the support, for the weight 1 - q³.
const FULL_VARIANCE = 0.15;
