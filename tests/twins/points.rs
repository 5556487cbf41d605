//! Densities and surfels of `graphs/parts/surfels.ron` against sums in 64-bit floats.

use meniscus::engine::Engine;
use meniscus::graph::value::Value;

use crate::ball;
use crate::device::{self, Done, Given, View};
use crate::field::{self, Field, Layout};
use crate::particles::file;

const VIEW: View = View { size: [16, 16], eye_z: 3.0, tan: 0.4 };
const RADIUS: f64 = 0.025;
const GRID: usize = 64;

/// The acceptance of the method's densities; the paper has 1.9 %.
const DENSITY_TOLERANCE: f64 = 1.0e-3;

fn third_parties() -> Vec<Vec<[f32; 3]>> {
    let names = ["double_dam_break_frame_26_4732_particles.vtk", "bunny_frame_14_7705_particles.vtk"];
    names.iter().filter_map(|name| file(&format!("../shared/data/splashsurf/{name}"))).collect()
}

/// The double dam break with which the repository comes, thinned so that it is done soon.
fn own() -> Vec<[f32; 3]> {
    let all = file("scenes/assets/dd40k_22.bgeo").expect("the repository has it");
    all.into_iter().filter(|p| p[0] < -0.6 && p[2] < 0.2).collect()
}

fn word(word: &str) -> Value {
    Value::Word(word.into())
}

fn surfels_of<'a>(engine: &'a mut Engine, positions: &[[f32; 3]], params: &[(&str, Value)], read: &[&str]) -> Done<'a> {
    let mut all = params.to_vec();
    if params.iter().all(|(name, _)| *name != "grid") {
        all.push(("grid", Value::Int(GRID as i64)));
    }
    device::run(
        engine,
        &Given { graph: "graphs/parts/surfels.ron", positions, radius: RADIUS, view: VIEW, params: &all, read },
    )
}

/// Texels of the atlas, or of layers behind each other, as densities of grid points.
fn unpacked(layout: &Layout, texel: impl Fn(usize, usize, usize) -> [f32; 4]) -> Vec<f64> {
    let [columns, levels, rows] = layout.points;
    let mut all = vec![0.0; columns * levels * rows];
    for y in 0..levels {
        for z in 0..rows {
            for x in 0..columns {
                all[layout.index(x, y, z)] = f64::from(texel(y / 4, x, z)[y % 4]);
            }
        }
    }
    all
}

fn from_atlas(engine: &mut Engine, positions: &[[f32; 3]], kernel: &str) -> Vec<f64> {
    let layout = Layout::of(positions, RADIUS, GRID);
    let [columns, levels, rows] = layout.points;
    let tiles = levels.div_ceil(4).min(8192 / columns);
    let texels = surfels_of(engine, positions, &[("kernel", word(kernel))], &["atlas"]).texels("atlas", 0);
    assert_eq!(texels.len(), columns * tiles * rows * levels.div_ceil(4).div_ceil(tiles));
    unpacked(&layout, tile_of(&layout, &texels))
}

/// The texel of a slab, x and z in the atlas.
fn tile_of(layout: &Layout, texels: &[[f32; 4]]) -> impl Fn(usize, usize, usize) -> [f32; 4] {
    let [columns, levels, rows] = layout.points;
    let tiles = levels.div_ceil(4).min(8192 / columns);
    move |slab, x, z| texels[((slab / tiles * rows) + z) * columns * tiles + slab % tiles * columns + x]
}

fn from_four_slices(engine: &mut Engine, positions: &[[f32; 3]]) -> Vec<f64> {
    let layout = Layout::of(positions, RADIUS, GRID);
    let graph = "tests/graphs/four_slices.ron";
    let params = [("grid", Value::Int(GRID as i64))];
    let given = Given { graph, positions, radius: RADIUS, view: VIEW, params: &params, read: &["all"] };
    let mut done = device::run(engine, &given);
    let slabs: Vec<_> = (0..layout.points[1].div_ceil(4)).map(|slab| done.texels("all", slab as u32)).collect();
    unpacked(&layout, |slab, x, z| slabs[slab][z * layout.points[0] + x])
}

fn relative_l2(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let off: f64 = found.iter().zip(expected).map(|(a, b)| (a - b) * (a - b)).sum();
    (off / expected.iter().map(|b| b * b).sum::<f64>()).sqrt()
}

pub fn densities_are_the_sums(engine: &mut Engine) {
    for positions in third_parties().into_iter().chain([own()]) {
        let layout = Layout::of(&positions, RADIUS, GRID);
        let expected = field::at_grid_points(&positions, &layout, |r| field::kernel(r, layout.reach));
        let atlas = from_atlas(engine, &positions, "formula");
        let error = relative_l2(&atlas, &expected);
        eprintln!("{} particles: relative L2 error of the densities {error:.2e}", positions.len());
        assert!(error < 1.0e-5, "{error:e} by formula");
        let error = relative_l2(&from_atlas(engine, &positions, "table"), &expected);
        assert!(error < DENSITY_TOLERANCE, "{error:e} by lookup");
        let apart = relative_l2(&from_four_slices(engine, &positions), &atlas);
        assert!(apart < 1.0e-6, "the layouts are {apart:e} apart");

        // What a slip would show: one wrong exponent, a reach that is half a percent off, one particle left out.
        let exponent = |r: f64| field::kernel(r, layout.reach) + 0.01 * (r / layout.reach).powi(5).min(1.0);
        let slips = [
            field::at_grid_points(&positions, &layout, exponent),
            field::at_grid_points(&positions, &layout, |r| field::kernel(r, 1.005 * layout.reach)),
            field::at_grid_points(&positions[1..], &layout, |r| field::kernel(r, layout.reach)),
        ];
        for (slip, expected) in slips.iter().enumerate() {
            let error = relative_l2(&atlas, expected);
            assert!(error > DENSITY_TOLERANCE, "slip {slip} would pass: {error:e}");
        }
    }
}

/// The particles and their images behind the floor of their box and the nearer walls, which are so high.
fn with_images(positions: &[[f32; 3]], layout: &Layout, walls_m: f64) -> Vec<[f32; 3]> {
    let (min, max) = device::bounds(positions);
    let near = layout.reach + 3.0 * layout.spacing;
    let mut all = Vec::new();
    for p in positions {
        let mut images = vec![p.map(f64::from)];
        for k in 0..3 {
            let (low, high) = (f64::from(min[k]) - RADIUS, f64::from(max[k]) + RADIUS);
            let x = f64::from(p[k]);
            let is_low = x - low <= high - x;
            let leans = f64::from(p[1]) - (f64::from(min[1]) - RADIUS) < walls_m;
            if (x - low).min(high - x) < near && if k == 1 { is_low } else { leans } {
                let image = 2.0 * if is_low { low } else { high } - x;
                images.extend(images.clone().into_iter().map(|mut p| {
                    p[k] = image;
                    p
                }));
            }
        }
        all.extend(images.into_iter().map(|p| p.map(|x| x as f32)));
    }
    all
}

/// Where a liquid rests, its densities are those with images behind floor and walls: in the box and a little beyond.
pub fn densities_go_on_behind_floor_and_walls(engine: &mut Engine) {
    let positions = own();
    let layout = Layout::of(&positions, RADIUS, GRID);
    let (min, max) = device::bounds(&positions);
    let [columns, levels, rows] = layout.points;
    let seen = |x: usize, y: usize, z: usize| {
        let at = [x, y, z];
        (0..3).all(|k| {
            let p = layout.origin[k] + layout.spacing * at[k] as f64;
            let beyond = if k == 1 { 0.0 } else { 1.5 * layout.spacing };
            p > f64::from(min[k]) - RADIUS - beyond && p < f64::from(max[k]) + RADIUS + beyond
        })
    };
    let inner = |all: &[f64]| -> Vec<f64> {
        let cells = (0..levels).flat_map(|y| (0..rows).flat_map(move |z| (0..columns).map(move |x| (x, y, z))));
        cells.filter(|(x, y, z)| seen(*x, *y, *z)).map(|(x, y, z)| all[layout.index(x, y, z)]).collect()
    };
    for walls_m in [0.0, 0.3, 10.0] {
        let params = [("rests", Value::Bool(true)), ("walls_m", Value::Float(walls_m))];
        let texels = surfels_of(engine, &positions, &params, &["atlas"]).texels("atlas", 0);
        let found = inner(&unpacked(&layout, tile_of(&layout, &texels)));
        let expected = with_images(&positions, &layout, walls_m);
        assert!(expected.len() > positions.len() + 500, "{} images", expected.len() - positions.len());
        let sums = |of: &[[f32; 3]]| inner(&field::at_grid_points(of, &layout, |r| field::kernel(r, layout.reach)));
        let error = relative_l2(&found, &sums(&expected));
        eprintln!("walls of {walls_m} m: relative L2 error of the densities {error:.2e}");
        assert!(error < 1.0e-5, "{error:e} with walls of {walls_m} m");
        for slip in [positions.clone(), with_images(&positions, &layout, if walls_m > 0.0 { 0.0 } else { 0.3 })] {
            assert!(relative_l2(&found, &sums(&slip)) > DENSITY_TOLERANCE, "other images would pass");
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Surfel {
    position: [f64; 3],
    radius: f64,
    normal: [f64; 3],
}

fn surfels(done: &Done<'_>) -> Vec<Surfel> {
    let words = done.words("surfels");
    let count = words[0] as usize;
    // The list's items begin at 16 bytes and take 32 each.
    let items = words[4..].chunks_exact(8).take(count);
    let number = |word: u32| f64::from(f32::from_bits(word));
    let all: Vec<Surfel> = items
        .map(|w| Surfel {
            position: [number(w[0]), number(w[1]), number(w[2])],
            radius: number(w[3]),
            normal: [number(w[4]), number(w[5]), number(w[6])],
        })
        .collect();
    assert_eq!(all.len(), count, "no more surfels than there is room for");
    all
}

/// Mean error of the density relative to the iso-level, and of the normals in degrees.
fn mean_errors(all: &[Surfel], field: &Field<'_>, iso: f64) -> (f64, f64) {
    let (mut off, mut degrees) = (0.0, 0.0);
    for surfel in all {
        let (density, gradient) = field.at(surfel.position);
        off += (density / iso - 1.0).abs();
        let cosine = -ball::dot(surfel.normal, ball::unit(gradient));
        degrees += cosine.clamp(-1.0, 1.0).acos().to_degrees();
    }
    (off / all.len() as f64, degrees / all.len() as f64)
}

pub fn surfels_lie_on_the_surface(engine: &mut Engine) {
    for positions in third_parties().into_iter().chain([own()]) {
        // Cells of a quarter of the effective radius; the paper's are smaller.
        let grid = (1..).map(|k| 16 * k).find(|grid| {
            let layout = Layout::of(&positions, RADIUS, *grid);
            4.0 * layout.spacing <= layout.reach
        });
        let grid = grid.expect("some grid is fine enough");
        let layout = Layout::of(&positions, RADIUS, grid);
        let field = Field::of(&positions, layout.reach);
        for iso in [0.3, 0.45, 0.6] {
            let params = [("grid", Value::Int(grid as i64)), ("iso", Value::Float(iso))];
            let all = surfels(&surfels_of(engine, &positions, &params, &["surfels"]));
            assert!(all.len() > 3_000, "{} surfels", all.len());
            let (off, degrees) = mean_errors(&all, &field, iso * layout.rest());
            eprintln!(
                "grid {grid}, iso {iso}: {} surfels, {:.2} % and {degrees:.2} degrees off",
                all.len(),
                100.0 * off
            );
            assert!(off < 0.01, "{off} off the iso-level {iso}");
            assert!(degrees < 2.0, "{degrees} degrees off");
            assert!(all.iter().all(|s| (s.radius / (1.3 * layout.spacing) - 1.0).abs() < 1.0e-4));

            let (wrong, _) = mean_errors(&all, &field, 1.02 * iso * layout.rest());
            assert!(wrong > 0.01, "an iso-level 2 % off would pass: {wrong}");
            let moved: Vec<Surfel> = all
                .iter()
                .map(|s| Surfel { normal: ball::unit([s.normal[0] + 0.06, s.normal[1] - 0.06, s.normal[2]]), ..*s })
                .collect();
            assert!(mean_errors(&moved, &field, iso * layout.rest()).1 > 2.0, "bent normals would pass");
        }
    }
}

/// Both layouts find the same surfels.
pub fn layouts_agree(engine: &mut Engine) {
    let positions = own();
    for rests in [false, true] {
        layouts_agree_on(engine, &positions, rests);
    }
}

fn layouts_agree_on(engine: &mut Engine, positions: &[[f32; 3]], rests: bool) {
    let spacing = Layout::of(positions, RADIUS, GRID).spacing;
    let mut found = ["atlas", "four_slices"].map(|holding| {
        let params = [("holding", word(holding)), ("rests", Value::Bool(rests)), ("walls_m", Value::Float(1.0))];
        let mut all = surfels(&surfels_of(engine, positions, &params, &["surfels"]));
        all.sort_by(|a, b| a.position.partial_cmp(&b.position).expect("numbers"));
        all
    });
    let [atlas, four] = &mut found;
    assert_eq!(atlas.len(), four.len());
    // Equal to rounding, so that equal places may have changed their order: each looks for its partner nearby.
    for (i, a) in atlas.iter().enumerate() {
        let nearby = &four[i.saturating_sub(64)..four.len().min(i + 65)];
        let partner = nearby.iter().any(|b| {
            let apart = [0, 1, 2].map(|k| a.position[k] - b.position[k]);
            ball::dot(apart, apart).sqrt() < 1.0e-4 * spacing && ball::dot(a.normal, b.normal) > 0.999_999
        });
        assert!(partner, "{a:?} has no partner");
    }
}

pub fn no_particles_and_no_level(engine: &mut Engine) {
    // A cube of particles, on a coarse grid.
    let at = |i: i32| [i % 8, i / 8 % 8, i / 64].map(|x| x as f32 * 2.0 * RADIUS as f32);
    let few: Vec<[f32; 3]> = (0..512).map(at).collect();
    let grid = ("grid", Value::Int(24));
    for holding in ["atlas", "four_slices"] {
        let given = [grid.clone(), ("holding", word(holding))];
        assert!(surfels(&surfels_of(engine, &[], &given, &["surfels"])).is_empty());
        for iso in [0.0, 90.0] {
            let given = [grid.clone(), ("holding", word(holding)), ("iso", Value::Float(iso))];
            assert!(surfels(&surfels_of(engine, &few, &given, &["surfels"])).is_empty(), "iso {iso}");
        }
        assert!(!surfels(&surfels_of(engine, &few, &given, &["surfels"])).is_empty(), "a level in between");
    }
    assert!(!surfels(&surfels_of(engine, &[[0.0; 3]], &[("iso", Value::Float(0.1))], &["surfels"])).is_empty());
}

/// As many surfels as the paper's scenes have at 256 grid points: of the surface that is seen, not of floor and walls.
pub fn as_many_surfels_as_in_the_paper(engine: &mut Engine) {
    let positions = file("scenes/assets/pool_drop.xyz").expect("the repository has it");
    let mut count = |grid: i64, rests: bool| {
        let params = [
            ("grid", Value::Int(grid)),
            ("holding", word("four_slices")),
            ("rests", Value::Bool(rests)),
            ("walls_m", Value::Float(0.62)),
        ];
        let graph = "graphs/parts/surfels.ron";
        let given =
            Given { graph, positions: &positions, radius: 0.016_667, view: VIEW, params: &params, read: &["surfels"] };
        surfels(&device::run(engine, &given)).len()
    };
    let seen = count(256, true);
    eprintln!("{seen} surfels");
    assert!((50_000..120_000).contains(&seen), "{seen} surfels");
    let (seen, all) = (count(96, true), count(96, false));
    assert!(all > seen * 3 / 2, "floor and walls count otherwise: {all} for {seen}");
}
