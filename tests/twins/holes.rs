//! The splatted surface of a shipped scene covers what its density covers, from wherever it is seen.

use glam::{Mat4, Vec3};
use meniscus::engine::Engine;
use meniscus::graph::value::Value;

use crate::device::{self, Given, View};
use crate::field::{self, Layout};
use crate::particles::file;

const VIEW: View = View { size: [72, 72], eye_z: 0.0, tan: 0.3 };
const RADIUS: f64 = 0.016_667;
const GRID: usize = 128;
const ISO: f64 = 0.45;
const VIEWPOINTS: usize = 50;

/// Viewpoints all around, from a small generator so that each run has the same.
fn viewpoints(middle: Vec3) -> Vec<Mat4> {
    let mut state = 7_u32;
    let mut next = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let mut eye = || {
        let (up, around) = (2.0 * next() - 1.0, std::f32::consts::TAU * next());
        let side = (1.0 - up * up).sqrt();
        middle + 4.5 * Vec3::new(side * around.cos(), up, side * around.sin())
    };
    (0..VIEWPOINTS)
        .map(|_| {
            let eye = eye();
            let back = (eye - middle).normalize();
            let right = Vec3::Y.cross(back).normalize();
            Mat4::from_cols(right.extend(0.0), back.cross(right).extend(0.0), back.extend(0.0), eye.extend(1.0))
        })
        .collect()
}

/// Metres of a pixel's ray that lie inside the surface, up to two cells.
fn inside_m(sums: &[f64], layout: &Layout, world_from_view: &Mat4, x: u32, y: u32) -> f64 {
    let direction = world_from_view.transform_vector3(Vec3::from(VIEW.direction(x, y).map(|d| d as f32)));
    let (step, iso) = (layout.spacing, ISO * layout.rest());
    let eye = world_from_view.w_axis.truncate();
    // There is nothing outside the grid.
    let grid = [layout.points[0], layout.points[1], layout.points[2]].map(|n| (n as f64 * layout.spacing) as f32);
    let low = Vec3::from(layout.origin.map(|x| x as f32));
    let (a, b) = ((low - eye) / direction, (low + Vec3::from(grid) - eye) / direction);
    let mut t = f64::from(a.min(b).max_element());
    let end = f64::from(a.max(b).min_element());
    let mut inside = 0.0;
    while t < end && inside < 2.0 * layout.spacing {
        let p = (eye + t as f32 * direction).to_array().map(f64::from);
        if field::between(sums, layout, p) > iso {
            inside += step;
        }
        t += step;
    }
    inside
}

/// Pixels that show nothing although their rays, and those of all pixels around, go through the water for two cells.
fn holes(z: &[f32], sums: &[f64], layout: &Layout, world_from_view: &Mat4) -> usize {
    let [width, height] = VIEW.size;
    let inner = (1..height - 1).flat_map(|y| (1..width - 1).map(move |x| (x, y)));
    let mut asked = vec![None; (width * height) as usize];
    let mut goes_through = |x: u32, y: u32| {
        let known = &mut asked[(y * width + x) as usize];
        *known.get_or_insert_with(|| inside_m(sums, layout, world_from_view, x, y) >= 2.0 * layout.spacing)
    };
    inner
        .filter(|(x, y)| z[(y * width + x) as usize] == 0.0)
        .filter(|(x, y)| (0..9).all(|k| goes_through(x + k % 3 - 1, y + k / 3 - 1)))
        .count()
}

fn from_all_sides(engine: &mut Engine, size: f64, contact: bool, viewpoints: &[Mat4]) -> (usize, usize) {
    let positions = file("scenes/assets/pool_drop.xyz").expect("the repository has it");
    let layout = Layout::of(&positions, RADIUS, GRID);
    let sums = field::at_grid_points(&positions, &layout, |r| field::kernel(r, layout.reach));
    let params = [
        ("water.grid", Value::Int(GRID as i64)),
        ("water.iso", Value::Float(ISO)),
        ("water.size", Value::Float(size)),
        ("contact", Value::Bool(contact)),
        ("exits", Value::Bool(false)),
    ];
    let given = Given {
        graph: "graphs/iwasaki2006.ron",
        positions: &positions,
        radius: RADIUS,
        view: VIEW,
        params: &params,
        read: &["front.z"],
    };
    let mut done = device::prepare(engine, &given);
    let (mut missing, mut covered) = (0, 0);
    for world_from_view in viewpoints {
        done.draw(VIEW, *world_from_view, [0.0, -1.0, 0.0]);
        let z: Vec<f32> = done.texels("front.z", 0).iter().map(|t| t[0]).collect();
        covered += z.iter().filter(|z| **z != 0.0).count();
        missing += holes(&z, &sums, &layout, world_from_view);
    }
    (missing, covered)
}

pub fn no_holes_from_anywhere(engine: &mut Engine) {
    let viewpoints = viewpoints(Vec3::new(1.0, 0.3, 0.7));
    let (missing, covered) = from_all_sides(engine, 1.3, false, &viewpoints);
    assert!(covered > VIEWPOINTS * 1_000, "{covered} pixels show water");
    assert_eq!(missing, 0, "holes in {covered} pixels");
    // Without what rests on the floor there are none from above it.
    let from_above: Vec<Mat4> = viewpoints.iter().filter(|v| v.w_axis.y > 0.5).copied().collect();
    assert!(from_above.len() > VIEWPOINTS / 4, "{} viewpoints", from_above.len());
    let (missing, _) = from_all_sides(engine, 1.3, true, &from_above);
    assert_eq!(missing, 0, "holes over a floor");
    // Surfels too small to meet leave holes, which are found.
    let (missing, _) = from_all_sides(engine, 0.5, false, &viewpoints[..2]);
    assert!(missing > 10, "{missing} holes");
}
