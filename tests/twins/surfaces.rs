//! Refraction and smoothing against closed forms.

use meniscus::engine::Engine;
use meniscus::graph::value::Value;

use crate::ball;
use crate::device::{self, Given, View};

/// A splash refracts as a ball of glass does, over the inner 90 % of its disc.
pub fn a_splash_is_a_glass_ball(engine: &mut Engine) {
    let (radius, distance, ior) = (0.3, 2.0, 1.333);
    let view = View { size: [400, 400], eye_z: distance as f32, tan: 0.18 };
    let given = Given {
        graph: "tests/graphs/glass_ball.ron",
        positions: &[[0.0; 3]],
        radius,
        view,
        params: &[("ior", Value::Float(ior))],
        read: &["leaving"],
    };
    let texels = device::run(engine, &given).texels("leaving", 0);
    let mut compared = 0;
    for y in 0..view.size[1] {
        for x in 0..view.size[0] {
            let Some(passage) = ball::pass(view.direction(x, y), [0.0, 0.0, -distance], radius, ior) else { continue };
            if passage.beside > 0.9 {
                continue;
            }
            let found = texels[(y * view.size[0] + x) as usize].map(f64::from);
            let direction = ball::unit([found[0], found[1], found[2]]);
            let degrees = ball::dot(direction, passage.direction).clamp(-1.0, 1.0).acos().to_degrees();
            assert!(degrees < 1.0, "{degrees} degrees off at {x}, {y}");
            assert!((found[3] / passage.path - 1.0).abs() < 0.01, "path {} for {}", found[3], passage.path);
            compared += 1;
        }
    }
    assert!(compared > 50_000, "{compared} pixels");
}

const SMOOTHED: View = View { size: [256, 256], eye_z: 0.0, tan: 0.364 };

/// Depths of the front layer after plane fitting and after the bilateral filter, and the truth.
struct Smoothed {
    fitted: Vec<f64>,
    filtered: Vec<f64>,
    truth: Vec<f64>,
}

fn smoothed(engine: &mut Engine, params: &[(&str, f64)], cut: bool) -> Smoothed {
    let mut all: Vec<(&str, Value)> = params.iter().map(|(name, value)| (*name, Value::Float(*value))).collect();
    all.push(("cut", Value::Bool(cut)));
    let given = Given {
        graph: "tests/graphs/plane_fit.ron",
        positions: &[],
        radius: 0.025,
        view: SMOOTHED,
        params: &all,
        read: &["fitted", "filtered", "truth"],
    };
    let mut done = device::run(engine, &given);
    let mut read = |name: &str| done.texels(name, 0).iter().map(|t| f64::from(t[0])).collect();
    Smoothed { fitted: read("fitted"), filtered: read("filtered"), truth: read("truth") }
}

/// How far five windows of nine pixels reach.
const REACH: usize = 21;

/// Relative errors at the pixels whose rows have a surface to both sides within reach, or none to the right if `rim`.
fn errors(z: &[f64], truth: &[f64], rim: bool) -> Vec<f64> {
    let width = SMOOTHED.size[0] as usize;
    let mut all = Vec::new();
    for y in REACH..width - REACH {
        for x in REACH..width - REACH {
            let at = y * width + x;
            let inside = truth[at - REACH] != 0.0 && truth[at] != 0.0;
            let ends = truth[at + REACH] == 0.0;
            if inside && ends == rim {
                all.push((z[at] / truth[at] - 1.0).abs());
            }
        }
    }
    assert!(all.len() > 1000, "{} pixels", all.len());
    assert!(all.iter().all(|e| *e < 0.1), "neither smooths a surface away");
    all
}

fn largest(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

fn root_mean_square(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

pub fn tilted_planes_stay_planes(engine: &mut Engine) {
    for tilt in [0.0, 30.0, 60.0, 75.0] {
        let depths = smoothed(engine, &[("tilt", tilt)], false);
        let worst = largest(&errors(&depths.fitted, &depths.truth, false));
        assert!(worst < 1.0e-4, "{worst:e} at {tilt} degrees");
    }
}

pub fn noise_falls_more_than_by_the_bilateral_filter(engine: &mut Engine) {
    for tilt in [0.0, 45.0, 60.0] {
        let depths = smoothed(engine, &[("tilt", tilt), ("noise_m", 0.01)], false);
        let fitted = root_mean_square(&errors(&depths.fitted, &depths.truth, false));
        let filtered = root_mean_square(&errors(&depths.filtered, &depths.truth, false));
        assert!(fitted < filtered, "{fitted:e} against {filtered:e} at {tilt} degrees");
        // Uniform noise of 1 cm at 4 m has a mean square root of 1.4e-3.
        assert!(fitted < 2.0e-4, "{fitted:e} at {tilt} degrees");
    }
}

/// The paper's problem 2: a filter pulls the rim of a surface towards the viewer.
pub fn rims_stay_where_they_are(engine: &mut Engine) {
    for tilt in [30.0, 45.0, 60.0] {
        let depths = smoothed(engine, &[("tilt", tilt)], true);
        let fitted = largest(&errors(&depths.fitted, &depths.truth, true));
        let filtered = largest(&errors(&depths.filtered, &depths.truth, true));
        assert!(fitted < 1.0e-4 && fitted < 0.1 * filtered, "{fitted:e} against {filtered:e} at {tilt} degrees");
    }
}
