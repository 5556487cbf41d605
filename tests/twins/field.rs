//! The density field of equation 1 (Iwasaki et al. 2006), summed in 64-bit floats.

use std::collections::HashMap;
use std::f64::consts::PI;

/// The grid that `graphs/parts/surfels.ron` lays around particles.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    pub reach: f64,
    pub origin: [f64; 3],
    pub spacing: f64,
    /// Grid points along x, y and z.
    pub points: [usize; 3],
}

impl Layout {
    pub fn of(positions: &[[f32; 3]], radius: f64, grid: usize) -> Self {
        let reach = 4.0 * radius;
        let (min, max) = crate::device::bounds(positions);
        let extent = [0, 1, 2].map(|k| f64::from(max[k]) - f64::from(min[k]) + 2.0 * reach);
        let spacing = extent.iter().copied().fold(0.0, f64::max) / (grid as f64 - 3.0);
        let points = extent.map(|e| ((e / spacing).ceil() as usize + 3).min(grid));
        Self { reach, origin: min.map(|x| f64::from(x) - reach - spacing), spacing, points }
    }

    /// Density of a lattice two radii apart, the unit of the iso-level.
    pub fn rest(&self) -> f64 {
        kernel(0.0, self.reach) * 0.194_708_995 * 4.0 / 3.0 * PI * 8.0
    }

    pub fn index(&self, x: usize, y: usize, z: usize) -> usize {
        (y * self.points[2] + z) * self.points[0] + x
    }
}

/// Equation 1 as printed, with the exponents of Wyvill's function.
pub fn kernel(r: f64, h: f64) -> f64 {
    if r > h {
        return 0.0;
    }
    let a = r / h;
    405.0 / (748.0 * PI * h) * (-4.0 / 9.0 * a.powi(6) + 17.0 / 9.0 * a.powi(4) - 22.0 / 9.0 * a.powi(2) + 1.0)
}

/// The sum of a function of the distance over particles, at every grid point.
pub fn at_grid_points(positions: &[[f32; 3]], layout: &Layout, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut sums = vec![0.0; layout.points.iter().product()];
    for p in positions {
        let at = [0, 1, 2].map(|k| (f64::from(p[k]) - layout.origin[k]) / layout.spacing);
        let reach = layout.reach / layout.spacing;
        let range = |k: usize| {
            let low = (at[k] - reach).floor().max(0.0) as usize;
            low..layout.points[k].min((at[k] + reach).ceil().max(0.0) as usize + 1)
        };
        for y in range(1) {
            for z in range(2) {
                for x in range(0) {
                    let beside = [x as f64 - at[0], y as f64 - at[1], z as f64 - at[2]];
                    let r = crate::ball::dot(beside, beside).sqrt() * layout.spacing;
                    sums[layout.index(x, y, z)] += f(r);
                }
            }
        }
    }
    sums
}

/// Density between grid points, trilinear; nothing outside.
pub fn between(sums: &[f64], layout: &Layout, p: [f64; 3]) -> f64 {
    let at = [0, 1, 2].map(|k| (p[k] - layout.origin[k]) / layout.spacing);
    if (0..3).any(|k| at[k] < 0.0 || at[k] >= (layout.points[k] - 1) as f64) {
        return 0.0;
    }
    let mut sum = 0.0;
    for corner in 0..8 {
        let mut weight = 1.0;
        let index = [0, 1, 2].map(|k| {
            let part = at[k].fract();
            let upper = corner >> k & 1;
            weight *= if upper == 1 { part } else { 1.0 - part };
            at[k] as usize + upper
        });
        sum += weight * sums[layout.index(index[0], index[1], index[2])];
    }
    sum
}

/// The field anywhere, by cells of one effective radius.
#[derive(Debug)]
pub struct Field<'a> {
    positions: &'a [[f32; 3]],
    reach: f64,
    cells: HashMap<[i64; 3], Vec<usize>>,
}

impl<'a> Field<'a> {
    pub fn of(positions: &'a [[f32; 3]], reach: f64) -> Self {
        let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for (i, p) in positions.iter().enumerate() {
            cells.entry(p.map(|x| (f64::from(x) / reach).floor() as i64)).or_default().push(i);
        }
        Self { positions, reach, cells }
    }

    /// Density and its gradient, the sum of each particle's derivative.
    pub fn at(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        let middle = p.map(|x| (x / self.reach).floor() as i64);
        let (mut sum, mut gradient) = (0.0, [0.0; 3]);
        for step in 0..27 {
            let cell = [middle[0] + step % 3 - 1, middle[1] + step / 3 % 3 - 1, middle[2] + step / 9 - 1];
            for &i in self.cells.get(&cell).into_iter().flatten() {
                let beside = [0, 1, 2].map(|k| p[k] - f64::from(self.positions[i][k]));
                let a = crate::ball::dot(beside, beside).sqrt() / self.reach;
                if a < 1.0 {
                    sum += kernel(a * self.reach, self.reach);
                    let slope = kernel(0.0, self.reach) * (-24.0 * a.powi(4) + 68.0 * a.powi(2) - 44.0) / 9.0;
                    for (sum, x) in gradient.iter_mut().zip(beside) {
                        *sum += slope * x / (self.reach * self.reach);
                    }
                }
            }
        }
        (sum, gradient)
    }
}
