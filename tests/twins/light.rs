//! Sample planes of `graphs/parts/caustics.ron` against closed forms: energy and focus.

use meniscus::engine::Engine;
use meniscus::graph::value::Value;

use crate::ball::{self, Vector};
use crate::device::{self, Given, SUN, View};

const VIEW: View = View { size: [16, 16], eye_z: 3.0, tan: 0.4 };
const LEVEL: f64 = 0.8;
const PLANES: usize = 5;
const ABSORPTION: [f64; 3] = [0.9, 0.22, 0.12];
const IOR: f64 = 1.333;

fn planes(engine: &mut Engine, params: &[(&str, Value)], sun: Vector, count: usize) -> Vec<Vec<[f64; 3]>> {
    let graph = "tests/graphs/lit_planes.ron";
    let given = Given { graph, positions: &[], radius: 0.01, view: VIEW, params, read: &["light.caustics"] };
    let mut done = device::run_lit(engine, &given, sun);
    let plane = |k: usize, done: &mut device::Done<'_>| {
        done.texels("light.caustics", k as u32).iter().map(|t| [0, 1, 2].map(|c| f64::from(t[c]))).collect()
    };
    (0..count).map(|k| plane(k, &mut done)).collect()
}

fn mean(plane: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|c| plane.iter().map(|t| t[c]).sum::<f64>() / plane.len() as f64)
}

/// Fresnel's transmittance of unpolarised light from the air into water.
fn transmittance(cosine: f64, ior: f64) -> f64 {
    let inner = (1.0 - (1.0 - cosine * cosine) / (ior * ior)).sqrt();
    let across = (cosine - ior * inner) / (cosine + ior * inner);
    let along = (ior * cosine - inner) / (ior * cosine + inner);
    1.0 - 0.5 * (across * across + along * along)
}

fn assert_near(found: [f64; 3], expected: [f64; 3], tolerance: f64, what: &str) {
    for c in 0..3 {
        let off = (found[c] / expected[c] - 1.0).abs();
        assert!(off < tolerance, "{what}, colour {c}: {} for {}", found[c], expected[c]);
    }
}

/// What each plane gets under level water: flux times transmittance times extinction.
fn under_level_water(depth: f64, sun: Vector, ior: f64) -> [f64; 3] {
    let bent = (1.0 - (1.0 - sun[1] * sun[1]) / (ior * ior)).sqrt();
    [0, 1, 2].map(|c| SUN[c] * -sun[1] * transmittance(-sun[1], ior) * (-ABSORPTION[c] * depth / bent).exp())
}

pub fn level_water_passes_the_flux(engine: &mut Engine) {
    for sun in [[0.0, -1.0, 0.0], ball::unit([-0.35, -0.85, -0.25])] {
        let all = planes(engine, &[], sun, PLANES);
        for (k, plane) in all.iter().enumerate().skip(1) {
            let depth = LEVEL * k as f64 / (PLANES - 1) as f64;
            let expected = under_level_water(depth, sun, IOR);
            assert_near(mean(plane), expected, 0.01, &format!("plane {k}"));
            for texel in plane {
                assert_near(*texel, expected, 0.02, &format!("a texel of plane {k}"));
            }
            // What would show: no transmittance, light that is 5 % longer under way.
            let slips = [
                [0, 1, 2].map(|c| expected[c] / transmittance(-sun[1], IOR)),
                under_level_water(1.05 * depth + 0.05, sun, IOR),
            ];
            for slip in slips {
                assert!((0..3).any(|c| (mean(plane)[c] / slip[c] - 1.0).abs() > 0.01), "{slip:?} would pass");
            }
        }
        // Blurred planes hold the same light; so do planes with a dispersion.
        for given in [("blur", Value::Int(2)), ("dispersion", Value::Float(0.03))] {
            let other = planes(engine, &[given], sun, PLANES);
            assert_near(mean(&other[PLANES - 1]), mean(&all[PLANES - 1]), 0.005, "blur or dispersion");
        }
    }
}

/// Slopes of the bump in `tests/graphs/lit_planes.wgsl`.
fn bump_slopes(x: f64, z: f64, height: f64, length: f64) -> [f64; 2] {
    let k = std::f64::consts::TAU / length;
    let (dx, dz) = (x - 0.5, z - 0.5);
    let inner = (1.0 - (dx * dx + dz * dz) / 0.1225).max(0.0);
    let waves = (k * x).sin() * (k * z).cos();
    let fade = [dx, dz].map(|d| -4.0 * inner * d / 0.1225);
    [
        height * (inner * inner * k * (k * x).cos() * (k * z).cos() + fade[0] * waves),
        height * (-inner * inner * k * (k * x).sin() * (k * z).sin() + fade[1] * waves),
    ]
}

/// Light without absorption under waves that end well inside the planes: nothing of it is lost or made.
pub fn waves_keep_the_light(engine: &mut Engine) {
    for (height, length) in [(0.01, 0.2), (0.02, 0.15), (0.03, 0.2)] {
        let params = [
            ("shape", Value::Word("bump".into())),
            ("height_m", Value::Float(height)),
            ("length_m", Value::Float(length)),
            ("across", Value::Int(96)),
            ("along", Value::Int(96)),
            ("plane_px", Value::Int(128)),
            ("absorption", Value::vec([0.0; 3])),
            ("top_m", Value::Float(LEVEL + 0.05)),
        ];
        let n = 400;
        let at = |i: usize| (i as f64 + 0.5) / n as f64;
        let through = |ior: f64| {
            let slopes = (0..n * n).map(|i| bump_slopes(at(i % n), at(i / n), height, length));
            slopes.map(|[x, z]| transmittance(1.0 / (1.0 + x * x + z * z).sqrt(), ior)).sum::<f64>() / (n * n) as f64
        };
        for (k, plane) in planes(engine, &params, [0.0, -1.0, 0.0], PLANES).iter().enumerate().skip(1) {
            let found = mean(plane);
            let expected = SUN.map(|e| e * through(IOR));
            assert_near(found, expected, 0.02, &format!("plane {k} under waves of {height} m"));
            let unlike = SUN.map(|e| e * through(1.7));
            assert!((found[1] / unlike[1] - 1.0).abs() > 0.02, "glass would pass");
            let spread = plane.iter().map(|t| t[1]).fold(0.0, f64::max) / found[1];
            assert!(k < 2 || spread > 1.5, "the waves focus the light: {spread}");
        }
    }
}

/// Cells that are cut where beams diverge bring most of what as many beams everywhere would, and lose no light.
pub fn cut_cells_come_near_to_many_beams(engine: &mut Engine) {
    let mut under = |px: i64, split: i64, tolerance: f64| {
        let params = [
            ("shape", Value::Word("bump".into())),
            ("height_m", Value::Float(0.01)),
            ("length_m", Value::Float(0.25)),
            ("across", Value::Int(px)),
            ("along", Value::Int(px)),
            ("split", Value::Int(split)),
            ("tolerance", Value::Float(tolerance)),
            ("plane_px", Value::Int(128)),
            ("absorption", Value::vec([0.0; 3])),
            ("top_m", Value::Float(LEVEL + 0.05)),
        ];
        planes(engine, &params, [0.0, -1.0, 0.0], PLANES).swap_remove(PLANES - 1)
    };
    let (fine, coarse, cut, all_cut) = (under(97, 1, 0.2), under(25, 1, 0.2), under(97, 4, 0.2), under(97, 4, 0.0));
    let off = |plane: &[[f64; 3]]| {
        plane.iter().zip(&fine).map(|(a, b)| (a[1] - b[1]).abs()).sum::<f64>() / fine.iter().map(|b| b[1]).sum::<f64>()
    };
    eprintln!(
        "off many beams by {:.4} with few, {:.4} with cut cells, {:.4} if all are",
        off(&coarse),
        off(&cut),
        off(&all_cut)
    );
    assert!(off(&cut) < 0.4 * off(&coarse), "{} for {}", off(&cut), off(&coarse));
    assert!(off(&all_cut) < 1.0e-3, "{}: all cells cut are many beams", off(&all_cut));
    assert_near(mean(&cut), mean(&fine), 0.005, "cut cells");
    // A plane under level water shows every gap; a tilted light makes none either.
    for sun in [[0.0, -1.0, 0.0], ball::unit([-0.35, -0.85, -0.25])] {
        let params = [("across", 61), ("along", 61), ("split", 4)].map(|(name, n)| (name, Value::Int(n)));
        let level = planes(engine, &params, sun, PLANES).swap_remove(PLANES - 1);
        let expected = under_level_water(LEVEL, sun, IOR);
        for texel in level {
            assert_near(texel, expected, 0.02, "a texel under level water");
        }
    }
}

/// The crest of a sine wave is a lens of radius 1 / (a k²), so its focus lies n / (n - 1) of that below it.
pub fn a_wave_focuses_as_a_lens_does(engine: &mut Engine) {
    let length = 0.1;
    let k = std::f64::consts::TAU / length;
    for expected in [0.4, 0.6] {
        let height = IOR / (IOR - 1.0) / expected / (k * k);
        let crest = LEVEL + height;
        let (count, px) = (33, 512);
        let [top, bottom] = [0.85, 1.15].map(|share| crest - share * expected);
        let params = [
            ("shape", Value::Word("wave".into())),
            ("height_m", Value::Float(height)),
            ("length_m", Value::Float(length)),
            ("across", Value::Int(512)),
            ("along", Value::Int(4)),
            ("plane_px", Value::Int(px as i64)),
            ("planes", Value::Int(count as i64)),
            ("region_min", Value::vec([-0.01, 0.0])),
            ("region_max", Value::vec([0.01, 0.02])),
            ("top_m", Value::Float(top)),
            ("bottom_m", Value::Float(bottom)),
            ("absorption", Value::vec([0.0; 3])),
        ];
        let all = planes(engine, &params, [0.0, -1.0, 0.0], count);
        let brightest = |plane: &Vec<[f64; 3]>| {
            let column = |x: usize| (0..px).map(|z| plane[z * px + x][1]).sum::<f64>() / px as f64;
            (0..px).map(|x| (column(x), x)).fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a })
        };
        let lines: Vec<(f64, usize)> = all.iter().map(brightest).collect();
        let best = (0..count).fold(0, |a, b| if lines[b].0 > lines[a].0 { b } else { a });
        let found = crest - top + (top - bottom) * best as f64 / (count - 1) as f64;
        let place = (lines[best].1 as f64 + 0.5) / px as f64 * 0.02 - 0.01;
        eprintln!("focus at {found:.4} m for {expected} m, {:.1} times as bright", lines[best].0 / SUN[1]);
        assert!((found / expected - 1.0).abs() < 0.03, "focus at {found} for {expected}");
        assert!(place.abs() < 0.03 * length, "brightest at {place}");
        // The index of ice would put it elsewhere.
        let ice = 1.309 / 0.309 / (height * k * k);
        assert!((found / ice - 1.0).abs() > 0.03, "another index would pass");
    }
}

/// The body of `graphs/imai2016.ron` loses what it reflects and no more of the light: by the surface that the light meets.
pub fn a_body_of_ellipsoids_keeps_the_light(engine: &mut Engine) {
    let positions = crate::particles::file("scenes/assets/dd40k_22.bgeo").expect("the repository has it");
    let positions: Vec<[f32; 3]> = positions.into_iter().filter(|p| p[0] < -0.6 && p[1] < 0.3).collect();
    let params = [
        ("caustics", Value::Bool(true)),
        ("screen", Value::Int(128)),
        ("plane_px", Value::Int(128)),
        ("planes", Value::Int(4)),
        ("absorption", Value::vec([0.0; 3])),
    ];
    let read = ["light.caustics", "above.surface"];
    let given = Given {
        graph: "graphs/imai2016.ron",
        positions: &positions,
        radius: 0.025,
        view: VIEW,
        params: &params,
        read: &read,
    };
    let mut done = device::run_lit(engine, &given, [0.0, -1.0, 0.0]);
    let surface = done.texels("above.surface", 0);
    let wet = surface.iter().filter(|t| t[1] > 0.0).count();
    assert!(wet * 20 > surface.len() && wet < surface.len(), "{wet} pixels of {} show the body", surface.len());
    let through = |ior: f64| {
        let each = surface.iter().map(|t| if t[1] > 0.0 { transmittance(f64::from(t[1]), ior) } else { 1.0 });
        each.sum::<f64>() / surface.len() as f64
    };
    for plane in 1..4 {
        let texels = done.texels("light.caustics", plane);
        let plane_light: Vec<[f64; 3]> = texels.iter().map(|t| [0, 1, 2].map(|c| f64::from(t[c]))).collect();
        assert_near(mean(&plane_light), SUN.map(|e| e * through(IOR)), 0.02, &format!("plane {plane}"));
        let brightest = plane_light.iter().map(|t| t[1]).fold(0.0, f64::max);
        assert!(plane < 3 || brightest > 2.0 * SUN[1], "the body gathers light: {brightest}");
    }
    assert!(through(IOR) / through(1.0) < 0.998 && through(3.0) / through(IOR) < 0.975, "glass would pass");
}

/// A light from below, or along the horizon, gives black planes.
pub fn light_from_below_lights_nothing(engine: &mut Engine) {
    for sun in [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], ball::unit([0.3, 0.1, 0.0])] {
        for plane in planes(engine, &[], sun, PLANES) {
            assert!(plane.iter().flatten().all(|x| *x == 0.0), "{sun:?}");
        }
    }
}
