//! The densities of a paper's size on the device, and the same sum on the processor: `cargo bench --bench densities`.
//!
//! 207,000 particles, a pool with waves and a block above it, 256 grid points along the longest edge. The processor sums in
//! 32-bit floats, on all its threads, each for grid planes of its own. Both are run in turn; the least time of each counts,
//! and their sums are compared. What the device takes for densities, and then for the points of the surface, is the
//! time that it tells of its passes.

#![allow(clippy::unwrap_used, dead_code, reason = "a bench fails by panicking, and uses part of what tests use")]

#[path = "../tests/twins/ball.rs"]
mod ball;
#[path = "../tests/twins/device.rs"]
mod device;

use std::f32::consts::PI;
use std::thread;
use std::time::Instant;

use device::{Given, View};
use meniscus::engine::{Engine, Gpu, GpuOptions, Report};
use meniscus::graph::value::Value;

const GRID: usize = 256;
const RADIUS: f32 = 0.0098;
const REPEATS: usize = 3;
const VIEW: View = View { size: [16, 16], eye_z: 3.0, tan: 0.4 };

/// From -0.5 to 0.5, the same in each run.
fn jitter(i: usize) -> f32 {
    let mixed = (i as u32).wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((mixed >> ((mixed >> 28) + 4)) ^ mixed).wrapping_mul(277_803_737);
    (word >> 8) as f32 / 16_777_216.0 - 0.5
}

/// A lattice of particles from a corner on.
fn block(all: &mut Vec<[f32; 3]>, corner: [f32; 3], counts: [usize; 3], wave_m: f32) {
    for i in 0..counts.iter().product() {
        let at = [i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]];
        let mut p = [0, 1, 2].map(|k| corner[k] + 2.0 * RADIUS * (at[k] as f32 + 0.2 * jitter(3 * i + k)));
        p[1] += wave_m * (9.0 * p[0]).sin() * (7.0 * p[2]).cos() * p[1];
        all.push(p);
    }
}

fn particles() -> Vec<[f32; 3]> {
    let mut all = Vec::new();
    block(&mut all, [0.0; 3], [102, 20, 70], 0.1);
    block(&mut all, [0.6, 0.6, 0.3], [40, 40, 40], 0.0);
    all
}

/// The grid that the graph lays around particles.
struct Layout {
    reach: f32,
    origin: [f32; 3],
    spacing: f32,
    points: [usize; 3],
}

impl Layout {
    fn of(positions: &[[f32; 3]]) -> Self {
        let reach = 4.0 * RADIUS;
        let (min, max) = device::bounds(positions);
        let extent = [0, 1, 2].map(|k| max[k] - min[k] + 2.0 * reach);
        let spacing = extent.iter().copied().fold(0.0, f32::max) / (GRID as f32 - 3.0);
        let points = extent.map(|e| ((e / spacing).ceil() as usize + 3).min(GRID));
        Self { reach, origin: min.map(|x| x - reach - spacing), spacing, points }
    }
}

/// One grid plane's densities, from the particles that reach it.
fn plane(positions: &[[f32; 3]], layout: &Layout, y: usize, out: &mut [f32]) {
    let peak = 405.0 / (748.0 * PI * layout.reach);
    let reach = layout.reach / layout.spacing;
    for p in positions {
        let at = [0, 1, 2].map(|k| (p[k] - layout.origin[k]) / layout.spacing);
        let away = y as f32 - at[1];
        let side_2 = reach * reach - away * away;
        if side_2 <= 0.0 {
            continue;
        }
        let side = side_2.sqrt();
        let range = |k: usize| {
            let low = (at[k] - side).ceil().max(0.0) as usize;
            low..layout.points[k].min((at[k] + side).floor().max(0.0) as usize + 1)
        };
        for z in range(2) {
            let row = &mut out[z * layout.points[0]..][..layout.points[0]];
            let far_2 = away * away + (z as f32 - at[2]) * (z as f32 - at[2]);
            for x in range(0) {
                let beside = x as f32 - at[0];
                let a = ((far_2 + beside * beside) / (reach * reach)).min(1.0);
                row[x] += peak * (1.0 + a * (-22.0 / 9.0 + a * (17.0 / 9.0 - a * (4.0 / 9.0))));
            }
        }
    }
}

/// All of them, each thread taking the next plane but so many; particles sorted by height, so that a plane sees its own.
fn on_processor(positions: &[[f32; 3]], layout: &Layout, threads: usize) -> Vec<f32> {
    let mut sorted = positions.to_vec();
    sorted.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let size = layout.points[0] * layout.points[2];
    let mut sums = vec![0.0; size * layout.points[1]];
    let mut shares: Vec<Vec<(usize, &mut [f32])>> = (0..threads).map(|_| Vec::new()).collect();
    for (y, out) in sums.chunks_mut(size).enumerate() {
        shares[y % threads].push((y, out));
    }
    let sorted = &sorted;
    thread::scope(|scope| {
        for share in shares {
            scope.spawn(move || {
                for (y, out) in share {
                    let height = layout.origin[1] + y as f32 * layout.spacing;
                    let first = sorted.partition_point(|p| p[1] < height - layout.reach);
                    let end = sorted.partition_point(|p| p[1] <= height + layout.reach);
                    plane(&sorted[first..end], layout, y, out);
                }
            });
        }
    });
    sums
}

/// Milliseconds of passes for the densities, and of those that find surfels.
fn shares(report: &Report) -> (f64, f64) {
    let is_search =
        |path: &str| ["find", "place"].iter().any(|name| path.split(['/', ' ', '[']).any(|word| word == *name));
    let sum = |search: bool| {
        let passes = report.passes.iter().filter(|pass| is_search(&pass.path) == search);
        passes.filter_map(|pass| pass.gpu_ms).sum()
    };
    (sum(false), sum(true))
}

fn on_device(engine: &mut Engine, positions: &[[f32; 3]], holding: &str) -> (f64, f64, Vec<[f32; 4]>) {
    let params = [("grid", Value::Int(GRID as i64)), ("holding", Value::Word(holding.into()))];
    let read: &[&str] = if holding == "atlas" { &["surfels", "atlas"] } else { &["surfels"] };
    let graph = "graphs/parts/surfels.ron";
    let given = Given { graph, positions, radius: f64::from(RADIUS), view: VIEW, params: &params, read };
    let mut done = device::prepare(engine, &given);
    done.time_all();
    let mut best = (f64::MAX, f64::MAX);
    for _ in 0..=REPEATS {
        let report = done.draw(VIEW, glam::Mat4::IDENTITY, [0.0, -1.0, 0.0]);
        let (density, search) = shares(&report);
        best = (best.0.min(density), best.1.min(search));
    }
    let atlas = if holding == "atlas" { done.texels("atlas", 0) } else { Vec::new() };
    (best.0, best.1, atlas)
}

fn relative_l2(layout: &Layout, sums: &[f32], atlas: &[[f32; 4]]) -> f64 {
    let [columns, levels, rows] = layout.points;
    let tiles = levels.div_ceil(4).min(8192 / columns);
    let (mut off, mut all) = (0.0, 0.0);
    for (i, expected) in sums.iter().enumerate() {
        let (x, z, y) = (i % columns, i / columns % rows, i / columns / rows);
        let texel = atlas[(y / 4 / tiles * rows + z) * columns * tiles + y / 4 % tiles * columns + x];
        off += f64::from(texel[y % 4] - expected).powi(2);
        all += f64::from(*expected).powi(2);
    }
    (off / all).sqrt()
}

fn main() {
    let Ok(gpu) = Gpu::open(&GpuOptions::default()) else {
        println!("no usable graphics adapter: nothing to compare with");
        return;
    };
    println!("device: {}", gpu.info().name);
    let mut engine = Engine::new(gpu);
    let positions = particles();
    let layout = Layout::of(&positions);
    let [columns, levels, rows] = layout.points;
    println!("{} particles, {columns} x {levels} x {rows} grid points", positions.len());
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let mut sums = Vec::new();
    let mut time = |threads: usize| {
        let each = (0..REPEATS).map(|_| {
            let began = Instant::now();
            sums = on_processor(&positions, &layout, threads);
            began.elapsed().as_secs_f64() * 1e3
        });
        each.fold(f64::MAX, f64::min)
    };
    let (one, all) = (time(1), time(threads));
    println!("processor: {one:.0} ms on one thread, {all:.0} ms on {threads}");
    for holding in ["atlas", "four_slices"] {
        let (density, search, atlas) = on_device(&mut engine, &positions, holding);
        let times = format!("densities {density:.0} ms, surfels {search:.0} ms");
        println!("device, {holding}: {times}; {:.2} times the threads, {:.2} times one", all / density, one / density);
        if !atlas.is_empty() {
            let error = relative_l2(&layout, &sums, &atlas);
            println!("relative L2 difference {error:.1e} (the paper: 1.9e-2)");
            assert!(error < 1.0e-3, "the processor sums something else: {error:e}");
        }
    }
}
