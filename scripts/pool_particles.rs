//! The particles of scenes/pool_drop.ron and scenes/pool_waves.ron: a small position-based solver (Macklin and Müller
//! 2013) in a box. One file without dependencies:
//!
//!     rustc -O scripts/pool_particles.rs -o /tmp/pool_particles
//!     /tmp/pool_particles drop 0.42 scenes/assets/pool_drop.xyz
//!     /tmp/pool_particles waves 2.9 scenes/assets/pool_waves.xyz
//!
//! Writes positions in metres as raw little-endian f32 triples, y up. The same call gives the same file.

const SPACING: f32 = 1.0 / 30.0;
/// Radius of the kernel: the particles' radius is half their spacing.
const REACH: f32 = 2.0 * SPACING;
const POOL: [f32; 3] = [2.0, 4.0, 1.4];
const DEPTH: f32 = 0.4;
const STEP: f32 = 1.0 / 240.0;
const ITERATIONS: usize = 6;

fn main() {
    let given: Vec<String> = std::env::args().collect();
    let [_, kind, seconds, file] = given.as_slice() else { panic!("pool_particles drop|waves SECONDS FILE") };
    let mut fluid = Fluid::new(kind == "drop");
    let steps = (seconds.parse::<f32>().expect("seconds") / STEP).round() as usize;
    for step in 0..steps {
        // A wall that moves to and fro makes the waves.
        let wall = if kind == "waves" { 0.09 * (1.0 - (step as f32 * STEP * 6.8).cos()) } else { 0.0 };
        fluid.step(wall);
    }
    let bytes: Vec<u8> = fluid.at.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(file, bytes).expect("the file can be written");
    let highest = fluid.at.iter().map(|p| p[1]).fold(0.0, f32::max);
    println!("{} particles, highest at {highest} m", fluid.at.len());
}

struct Fluid {
    at: Vec<[f32; 3]>,
    velocity: Vec<[f32; 3]>,
    rest: f32,
    seed: u32,
}

fn difference(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn poly6(squared: f32) -> f32 {
    let rest = (REACH * REACH - squared).max(0.0) / (REACH * REACH);
    rest * rest * rest
}

/// The spiky kernel's slope over the distance, so that it multiplies the offset.
fn spiky(distance: f32) -> f32 {
    let rest = (1.0 - distance / REACH).max(0.0);
    -3.0 * rest * rest / (REACH * distance.max(1.0e-6))
}

/// Turns the spiky kernel's scale into that of poly6: both are left without their constants.
const SLOPE: f32 = 15.0 / 3.141_592_7 / (315.0 / (64.0 * 3.141_592_7));

impl Fluid {
    fn new(drop: bool) -> Self {
        let mut fluid = Self { at: Vec::new(), velocity: Vec::new(), rest: 0.0, seed: 1 };
        fluid.fill([0.0; 3], [POOL[0], DEPTH, POOL[2]], 0.0);
        if drop {
            // A parallelepiped, a little turned, already falling.
            fluid.fill([0.65, 0.5, 0.4], [1.25, 0.95, 0.95], -2.0);
        }
        let reach = (REACH / SPACING) as i32;
        for x in -reach..=reach {
            for y in -reach..=reach {
                for z in -reach..=reach {
                    fluid.rest += poly6((x * x + y * y + z * z) as f32 * SPACING * SPACING);
                }
            }
        }
        fluid
    }

    fn random(&mut self) -> f32 {
        self.seed = self.seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.seed >> 8) as f32 / 16_777_216.0 - 0.5
    }

    fn fill(&mut self, low: [f32; 3], high: [f32; 3], falling: f32) {
        let counts = [0, 1, 2].map(|k| ((high[k] - low[k]) / SPACING).round() as usize);
        for y in 0..counts[1] {
            for z in 0..counts[2] {
                for x in 0..counts[0] {
                    let p = [x, y, z].map(|i| (i as f32 + 0.5) * SPACING);
                    let jitter = [0; 3].map(|_: i32| 0.02 * SPACING * self.random());
                    self.at.push([0, 1, 2].map(|k| low[k] + p[k] + jitter[k]));
                    self.velocity.push([0.0, falling, 0.0]);
                }
            }
        }
    }

    fn step(&mut self, wall: f32) {
        let mut next: Vec<[f32; 3]> = self.at.clone();
        for (p, v) in next.iter_mut().zip(&mut self.velocity) {
            v[1] -= 9.81 * STEP;
            for k in 0..3 {
                p[k] += v[k] * STEP;
            }
            contain(p, wall);
        }
        let neighbours = neighbours(&next);
        for _ in 0..ITERATIONS {
            let lambda: Vec<f32> = next.iter().zip(&neighbours).map(|(p, near)| self.lambda(*p, near, &next)).collect();
            let moved: Vec<[f32; 3]> =
                (0..next.len()).map(|i| self.push(i, &neighbours[i], &next, &lambda)).collect();
            for (p, move_by) in next.iter_mut().zip(moved) {
                for k in 0..3 {
                    p[k] += move_by[k];
                }
                contain(p, wall);
            }
        }
        for i in 0..next.len() {
            self.velocity[i] = difference(next[i], self.at[i]).map(|x| x / STEP);
        }
        let smoothed: Vec<[f32; 3]> = (0..next.len()).map(|i| self.smoothed(i, &neighbours[i], &next)).collect();
        self.velocity = smoothed;
        self.at = next;
    }

    fn lambda(&self, p: [f32; 3], near: &[u32], all: &[[f32; 3]]) -> f32 {
        let (mut density, mut sum, mut own) = (1.0, 0.0, [0.0; 3]);
        for &j in near {
            let away = difference(p, all[j as usize]);
            let squared = away.iter().map(|x| x * x).sum::<f32>();
            density += poly6(squared);
            let slope = SLOPE * spiky(squared.sqrt()) / self.rest;
            for k in 0..3 {
                own[k] += slope * away[k];
                sum += slope * slope * away[k] * away[k];
            }
        }
        sum += own.iter().map(|x| x * x).sum::<f32>();
        // Only pressure, no suction: free surfaces may be thin.
        -(density / self.rest - 1.0).max(0.0) / (sum + 60.0)
    }

    fn push(&self, i: usize, near: &[u32], all: &[[f32; 3]], lambda: &[f32]) -> [f32; 3] {
        let mut move_by = [0.0; 3];
        for &j in near {
            let away = difference(all[i], all[j as usize]);
            let distance = away.iter().map(|x| x * x).sum::<f32>().sqrt();
            let factor = (lambda[i] + lambda[j as usize]) * SLOPE * spiky(distance) / self.rest;
            for k in 0..3 {
                move_by[k] += factor * away[k];
            }
        }
        move_by
    }

    /// Velocity with a little of the neighbours' mixed in.
    fn smoothed(&self, i: usize, near: &[u32], all: &[[f32; 3]]) -> [f32; 3] {
        let mut v = self.velocity[i];
        for &j in near {
            let away = difference(all[i], all[j as usize]);
            let weight = 0.02 * poly6(away.iter().map(|x| x * x).sum()) / self.rest * 8.0;
            let other = difference(self.velocity[j as usize], self.velocity[i]);
            for k in 0..3 {
                v[k] += weight * other[k];
            }
        }
        v
    }
}

/// Within the pool, whose lower x wall has moved in.
fn contain(p: &mut [f32; 3], wall: f32) {
    let margin = 0.5 * SPACING;
    for k in 0..3 {
        let low = if k == 0 { wall } else { 0.0 };
        p[k] = p[k].clamp(low + margin, POOL[k] - margin);
    }
}

fn neighbours(at: &[[f32; 3]]) -> Vec<Vec<u32>> {
    let counts = POOL.map(|size| (size / REACH).ceil() as usize + 1);
    let cell = |p: &[f32; 3]| [0, 1, 2].map(|k| ((p[k] / REACH) as usize).min(counts[k] - 1));
    let mut cells = vec![Vec::new(); counts.iter().product()];
    for (i, p) in at.iter().enumerate() {
        let [x, y, z] = cell(p);
        cells[(y * counts[2] + z) * counts[0] + x].push(i as u32);
    }
    let around = |i: usize| {
        let [x, y, z] = cell(&at[i]);
        let mut near = Vec::new();
        for y in y.saturating_sub(1)..=(y + 1).min(counts[1] - 1) {
            for z in z.saturating_sub(1)..=(z + 1).min(counts[2] - 1) {
                for x in x.saturating_sub(1)..=(x + 1).min(counts[0] - 1) {
                    for &j in &cells[(y * counts[2] + z) * counts[0] + x] {
                        let squared = difference(at[i], at[j as usize]).iter().map(|x| x * x).sum::<f32>();
                        if j as usize != i && squared < REACH * REACH {
                            near.push(j);
                        }
                    }
                }
            }
        }
        near
    };
    (0..at.len()).map(around).collect()
}
