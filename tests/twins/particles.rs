//! Neighbour grid, density, ellipsoids and classes against their twins.

use std::path::Path;
use std::time::{Duration, Instant};

use meniscus::engine::Engine;
use meniscus::graph::value::Value;
use meniscus::scene::particles;

use crate::device::{self, Given, View};
use crate::{grid, shapes};

const VIEW: View = View { size: [16, 16], eye_z: 3.0, tan: 0.4 };

/// Relative error of 32-bit results that the method's acceptance allows.
const TOLERANCE: f64 = 1.0e-3;

/// Points in a box, from a small generator so that each run has the same.
fn scattered(count: usize, box_size: [f32; 3]) -> Vec<[f32; 3]> {
    let mut state = 1_u32;
    let mut next = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    (0..count).map(|_| box_size.map(|size| next() * size)).collect()
}

/// A particle file of the repository or of the data beside it; says so where it is not there.
pub fn file(name: &str) -> Option<Vec<[f32; 3]>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    let Ok(bytes) = std::fs::read(&path) else {
        eprintln!("skipped: {name} is not there");
        return None;
    };
    let read = particles::read(&path, &bytes).unwrap_or_else(|e| panic!("{name}: {e:?}"));
    Some(read.positions().into_owned())
}

/// Every cell holds exactly the particles that lie in it, in the order of the file.
fn grid_holds(engine: &mut Engine, positions: &[[f32; 3]], cell_size: f64) {
    let given = Given {
        graph: "graphs/parts/neighbour_grid.ron",
        positions,
        radius: cell_size / 4.0,
        view: VIEW,
        params: &[("cell_size", Value::Float(cell_size))],
        read: &["cell_start", "sorted"],
    };
    let done = device::run(engine, &given);
    let (min, max) = device::bounds(positions);
    let sizes = grid::sizes(positions.len(), min, max, cell_size);
    let keys = grid::keys(positions, min, cell_size as f32, sizes);
    let start = done.words("cell_start");
    assert_eq!(start.len(), sizes.iter().product::<u32>() as usize + 1);
    if positions.is_empty() {
        assert!(start.iter().all(|s| *s == 0));
        return;
    }
    let sorted = done.words("sorted");
    let mut expected: Vec<usize> = (0..positions.len()).collect();
    expected.sort_by_key(|i| keys[*i]);
    for (at, i) in expected.iter().enumerate() {
        assert_eq!(sorted[4 * at + 3] as usize, *i, "at place {at}");
        assert_eq!([0, 1, 2].map(|k| f32::from_bits(sorted[4 * at + k])), positions[*i]);
    }
    for (cell, first) in start.iter().enumerate() {
        assert_eq!(*first as usize, expected.partition_point(|i| (keys[*i] as usize) < cell), "cell {cell}");
    }
}

pub fn grid_of_none_one_and_seven(engine: &mut Engine) {
    grid_holds(engine, &[], 0.1);
    grid_holds(engine, &scattered(1, [1.0; 3]), 0.1);
    grid_holds(engine, &scattered(7, [1.0; 3]), 0.1);
}

pub fn grid_of_a_few_thousand(engine: &mut Engine) {
    grid_holds(engine, &scattered(4_732, [1.0, 0.5, 0.8]), 0.1);
}

pub fn grid_of_a_million(engine: &mut Engine) {
    grid_holds(engine, &scattered(1_000_000, [4.0, 2.0, 4.0]), 0.05);
}

pub fn grid_with_all_in_one_cell(engine: &mut Engine) {
    let began = Instant::now();
    grid_holds(engine, &scattered(1_000_000, [0.04; 3]), 0.05);
    grid_holds(engine, &vec![[0.25, -1.0, 7.0]; 10_000], 0.05);
    assert!(began.elapsed() < Duration::from_secs(120), "{:?}", began.elapsed());
}

pub fn grid_with_some_far_out(engine: &mut Engine) {
    let mut positions = scattered(5_000, [1.0; 3]);
    positions.extend([[1000.0, 5.0, -3000.0], [-1000.0, 2.0e5, 30.0]]);
    grid_holds(engine, &positions, 0.1);
}

fn relative(found: f64, expected: f64, unit: f64) -> f64 {
    (found - expected).abs() / unit
}

/// Moments, ellipsoids and classes of one set of particles.
fn shapes_agree(engine: &mut Engine, positions: &[[f32; 3]], radius: f64) {
    let read = &["moments", "ellipsoid", "is_body", "body", "splash"];
    let given = Given { graph: "graphs/parts/ellipsoids.ron", positions, radius, view: VIEW, params: &[], read };
    let done = device::run(engine, &given);
    let (moments, ellipsoids, is_body) = (done.floats("moments"), done.floats("ellipsoid"), done.words("is_body"));
    let settings = shapes::Settings::of(radius);
    for (i, neighbours) in grid::neighbours(positions, settings.support).iter().enumerate() {
        let expected = shapes::moments(neighbours, radius, settings.support);
        let found = &moments[12 * i..12 * i + 12];
        assert!(relative(f64::from(found[3]), expected.density, expected.density) < TOLERANCE, "density of {i}");
        let covariance =
            [[found[4], found[8], found[10]], [found[8], found[5], found[9]], [found[10], found[9], found[6]]];
        let size = norm(&expected.covariance).max(1.0e-3 * radius * radius);
        for (a, row) in covariance.iter().enumerate() {
            for (b, value) in row.iter().enumerate() {
                let error = relative(f64::from(*value), expected.covariance[a][b], size);
                assert!(error < TOLERANCE, "covariance of {i}: {error:e}");
            }
        }
        // A density right at the threshold may fall either way.
        if (expected.density / settings.splash_below - 1.0).abs() > 1.0e-5 {
            let shape = shapes::shape(&expected, &settings);
            assert_eq!(is_body[i] == 1, shape.is_body, "class of {i}");
            shape_agrees(i, &ellipsoids[12 * i..12 * i + 12], positions[i], &shape, radius);
        }
    }
    lists_are_complete(&done.words("body"), &done.words("splash"), &is_body);
}

/// Which particles are in groups of fewer than `below` that hang together, by comparing all with all.
fn strays(positions: &[[f32; 3]], reach: f64, below: usize) -> Vec<bool> {
    let neighbours = grid::neighbours(positions, reach);
    let mut group = vec![usize::MAX; positions.len()];
    let mut stray = vec![false; positions.len()];
    for first in 0..positions.len() {
        if group[first] != usize::MAX {
            continue;
        }
        let mut members = vec![first];
        group[first] = first;
        let mut at = 0;
        while at < members.len() {
            for (other, _) in &neighbours[members[at]] {
                if group[*other] == usize::MAX {
                    group[*other] = first;
                    members.push(*other);
                }
            }
            at += 1;
        }
        members.iter().for_each(|i| stray[*i] = members.len() < below);
    }
    stray
}

/// Particles that are in neither list, after lists that leave out groups of fewer than `below`.
fn left_out(engine: &mut Engine, positions: &[[f32; 3]], radius: f64, below: i64) -> Vec<bool> {
    let params = &[("strays_below", Value::Int(below))];
    let given = Given {
        graph: "graphs/parts/ellipsoids.ron",
        positions,
        radius,
        view: VIEW,
        params,
        read: &["body", "splash"],
    };
    let done = device::run(engine, &given);
    let mut left_out = vec![true; positions.len()];
    for list in [done.words("body"), done.words("splash")] {
        let (count, items) = list.split_first().unwrap();
        let items = &items[..*count as usize];
        assert!(items.is_sorted(), "the lists keep the file's order");
        items.iter().for_each(|i| assert!(std::mem::take(&mut left_out[*i as usize]), "{i} is listed twice"));
    }
    left_out
}

pub fn strays_are_small_groups(engine: &mut Engine) {
    // Thin enough that there are groups of all sizes.
    let positions = scattered(3_000, [1.0, 0.5, 0.8]);
    let radius = 0.012;
    for below in [1, 2, 7, 40] {
        let expected = strays(&positions, 4.0 * radius, below as usize);
        let count = expected.iter().filter(|stray| **stray).count();
        assert_eq!(left_out(engine, &positions, radius, below), expected, "below {below}: {count}");
        assert!(below == 1 || (0 < count && count < positions.len()), "below {below}: {count}");
    }
    let heaped = [vec![[0.5; 3]; 3_000], vec![[0.9, 0.5, 0.5]; 3]].concat();
    let expected: Vec<bool> = (0..heaped.len()).map(|i| i >= 3_000).collect();
    assert_eq!(left_out(engine, &heaped, 0.01, 4), expected, "a heap is one group");
    assert_eq!(left_out(engine, &[], 0.01, 4), vec![false; 0]);
}

pub fn strays_do_not_depend_on_the_order_of_threads(engine: &mut Engine) {
    let positions = scattered(40_000, [1.0; 3]);
    let first = left_out(engine, &positions, 0.0045, 12);
    for _ in 0..4 {
        assert_eq!(left_out(engine, &positions, 0.0045, 12), first);
    }
}

fn norm(matrix: &[[f64; 3]; 3]) -> f64 {
    matrix.iter().flatten().map(|x| x * x).sum::<f64>().sqrt()
}

fn shape_agrees(i: usize, found: &[f32], position: [f32; 3], expected: &shapes::Shape, radius: f64) {
    let axes = [0, 4, 8].map(|k| [0, 1, 2].map(|a| f64::from(found[k + a])));
    let size = norm(&expected.outer);
    for a in 0..3 {
        let centre = f64::from(found[4 * a + 3]) - f64::from(position[a]);
        assert!(relative(centre, expected.centre[a], radius) < TOLERANCE, "centre of {i}");
        for b in 0..3 {
            let outer: f64 = axes.iter().map(|axis| axis[a] * axis[b]).sum();
            assert!(relative(outer, expected.outer[a][b], size) < TOLERANCE, "axes of {i}");
        }
    }
    let mut lengths = axes.map(|axis| axis.iter().map(|x| x * x).sum::<f64>().sqrt());
    lengths.sort_by(f64::total_cmp);
    for (length, expected) in lengths.iter().zip(expected.lengths) {
        assert!(relative(*length, expected, expected) < TOLERANCE, "lengths of {i}");
    }
}

/// Each particle stands in the list of its class, in ascending order.
fn lists_are_complete(body: &[u32], splash: &[u32], is_body: &[u32]) {
    for (list, class) in [(body, 1), (splash, 0)] {
        let expected: Vec<u32> = (0..is_body.len() as u32).filter(|i| is_body[*i as usize] == class).collect();
        assert_eq!(list[0] as usize, expected.len());
        assert_eq!(list[1..=expected.len()], expected);
    }
}

pub fn ellipsoids_of_the_dam_break(engine: &mut Engine) {
    let all = file("scenes/assets/dd40k_22.bgeo").expect("the repository has it");
    shapes_agree(engine, &all, 0.025);
}

pub fn ellipsoids_of_third_parties(engine: &mut Engine) {
    for name in ["double_dam_break_frame_26_4732_particles.vtk", "bunny_frame_14_7705_particles.vtk"] {
        if let Some(positions) = file(&format!("../shared/data/splashsurf/{name}")) {
            shapes_agree(engine, &positions, 0.025);
        }
    }
}

pub fn ellipsoids_of_lone_and_heaped_particles(engine: &mut Engine) {
    shapes_agree(engine, &[[0.1, 0.2, 0.3]], 0.025);
    shapes_agree(engine, &[[0.1, 0.2, 0.3], [0.14, 0.2, 0.3], [0.9, 0.2, 0.3]], 0.025);
    // On one point: no spread, so no shape to compare, but finite numbers all the same.
    let heap = vec![[0.1, 0.2, 0.3]; 3_000];
    let given = Given {
        graph: "graphs/parts/ellipsoids.ron",
        positions: &heap,
        radius: 0.025,
        view: VIEW,
        params: &[],
        read: &["ellipsoid", "moments"],
    };
    let done = device::run(engine, &given);
    assert!(done.floats("ellipsoid").iter().chain(&done.floats("moments")).all(|x| x.is_finite()));
}
