//! Density, covariance and ellipsoids of particles in 64-bit floats, from the formulas and not from the shaders.

use std::f64::consts::PI;

/// What the neighbours of one particle say.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    pub density: f64,
    /// Weighted mean, as an offset from the particle.
    pub mean: [f64; 3],
    pub covariance: [[f64; 3]; 3],
}

/// Müller et al. 2003 for the density, Yu and Turk 2013 (equations 9 to 11) for the rest.
pub fn moments(neighbours: &[(usize, [f64; 3])], radius: f64, support: f64) -> Moments {
    let kernel = |d: f64| 315.0 / (64.0 * PI * support.powi(9)) * (support * support - d * d).powi(3);
    let mut density = kernel(0.0);
    let mut all: Vec<(f64, [f64; 3])> = vec![(1.0, [0.0; 3])];
    for (_, offset) in neighbours {
        let d = offset.iter().map(|x| x * x).sum::<f64>().sqrt();
        density += kernel(d);
        all.push((1.0 - (d / support).powi(3), *offset));
    }
    let weight: f64 = all.iter().map(|(w, _)| w).sum();
    let mean = [0, 1, 2].map(|k| all.iter().map(|(w, x)| w * x[k]).sum::<f64>() / weight);
    let covariance = [0, 1, 2].map(|a| {
        [0, 1, 2].map(|b| all.iter().map(|(w, x)| w * (x[a] - mean[a]) * (x[b] - mean[b])).sum::<f64>() / weight)
    });
    Moments { density: density * (2.0 * radius).powi(3), mean, covariance }
}

/// What `graphs/parts/ellipsoids.ron` has as parameters.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub radius: f64,
    pub support: f64,
    pub splash_below: f64,
    pub splash_size: f64,
    pub body_size: f64,
    pub stretch_max: f64,
    pub ratio_max: f64,
    pub smoothing: f64,
}

impl Settings {
    /// The part's defaults for a particle radius.
    pub fn of(radius: f64) -> Self {
        Settings {
            radius,
            support: 4.0 * radius,
            splash_below: 0.4,
            splash_size: 1.0,
            body_size: 1.2,
            stretch_max: 1.2,
            ratio_max: 4.0,
            smoothing: 0.9,
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Shape {
    pub is_body: bool,
    /// Offset of the centre from the particle.
    pub centre: [f64; 3],
    /// Sum of the half-axes' outer products: the same for every choice of signs and order.
    pub outer: [[f64; 3]; 3],
    /// Half-axes, ascending.
    pub lengths: [f64; 3],
}

pub fn shape(m: &Moments, s: &Settings) -> Shape {
    if m.density < s.splash_below {
        let r = s.splash_size * s.radius;
        let outer = [[r * r, 0.0, 0.0], [0.0, r * r, 0.0], [0.0, 0.0, r * r]];
        return Shape { is_body: false, centre: [0.0; 3], outer, lengths: [r; 3] };
    }
    let (values, vectors) = eigen(m.covariance);
    let spread = values.map(|v| v / (0.15 * s.support * s.support));
    let largest = spread.iter().copied().fold(0.0, f64::max);
    let size = spread.map(|v| s.radius * (s.body_size * v.max(largest / s.ratio_max)).clamp(0.01, s.stretch_max));
    let outer =
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| (0..3).map(|k| vectors[k][a] * vectors[k][b] * size[k] * size[k]).sum()));
    let mut lengths = size;
    lengths.sort_by(f64::total_cmp);
    Shape { is_body: true, centre: m.mean.map(|x| x * s.smoothing), outer, lengths }
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix: the largest element off the diagonal is turned away until
/// none is left.
pub fn eigen(matrix: [[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut m = matrix;
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..64 {
        let (p, q) = [(0, 1), (0, 2), (1, 2)]
            .into_iter()
            .max_by(|a, b| m[a.0][a.1].abs().total_cmp(&m[b.0][b.1].abs()))
            .unwrap_or((0, 1));
        if m[p][q] == 0.0 {
            break;
        }
        let angle = 0.5 * (2.0 * m[p][q]).atan2(m[q][q] - m[p][p]);
        let (sine, cosine) = angle.sin_cos();
        for row in &mut m {
            (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
        }
        for rows in [&mut m, &mut v] {
            let (a, b) = (rows[p], rows[q]);
            rows[p] = [0, 1, 2].map(|k| cosine * a[k] - sine * b[k]);
            rows[q] = [0, 1, 2].map(|k| sine * a[k] + cosine * b[k]);
        }
    }
    ([m[0][0], m[1][1], m[2][2]], v)
}
