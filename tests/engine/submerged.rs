//! Things in, before and above the liquid, in every method: seen, absorbed, hidden.

use std::ops::Range;
use std::path::PathBuf;

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::Engine;
use meniscus::files::MemoryFiles;
use meniscus::host::{Cache, Job, Moment, Session, load};

const GRAPHS: [&str; 3] = ["imai2016.ron", "imai2014.ron", "iwasaki2006.ron"];

/// Without liquid the floor would lie right under the square.
const NO_FLOOR: &[(&str, &str)] = &[("dry.floor", "false")];

/// A level square of 0.6 m.
const SQUARE: &str = "v -0.3 0 -0.3\nv -0.3 0 0.3\nv 0.3 0 0.3\nv 0.3 0 -0.3";
/// A board of 0.17 m by 0.9 m that stands upright near an edge of the pool and faces it.
const POST: &str = "v 0.29 0 0.41\nv 0.41 0 0.29\nv 0.41 0.9 0.29\nv 0.29 0.9 0.41";
pub const ABOVE: &str = "eye: (0, 2.6, 1.3), target: (0, 0.25, 0)";
/// Through two sides of the pool, from before the edge between them.
const ASIDE: &str = "eye: (2.3, 1.6, 2.3), target: (0, 0.5, 0)";

/// A level red square, and a pool of 1.5 m that is 0.5 m deep, if there is one.
fn files(graph: &str, height_m: f64, is_pool: bool) -> MemoryFiles {
    seen(graph, SQUARE, ABOVE, height_m, if is_pool { 10 } else { 0 })
}

/// Something red in a pool of 1.5 m with so many layers of particles, 0.05 m apart.
fn seen(graph: &str, corners: &str, camera: &str, height_m: f64, layers: usize) -> MemoryFiles {
    let obj = format!("mtllib red.mtl\n{corners}\nusemtl red\nf 1 2 3 4\n");
    pool(graph, "red.obj", camera, height_m, layers)
        .with("red.obj", obj)
        .with("red.mtl", "newmtl red\nKd 0.8 0.02 0.02\nPr 0.9\n")
}

/// A mesh file in such a pool.
pub fn pool(graph: &str, mesh: &str, camera: &str, height_m: f64, layers: usize) -> MemoryFiles {
    let is_pool = layers > 0;
    let place = |i: usize| [i % 30, i / 900, i / 30 % 30].map(|n| n as f64 * 0.05);
    let rows =
        (0..900 * layers).map(place).map(|[x, y, z]| format!("{:.3},{:.3},{:.3}\n", x - 0.725, y + 0.025, z - 0.725));
    let particles = if is_pool { "particles: {\"particles\": (file: \"pool.csv\", radius: 0.025)}," } else { "" };
    let scene = format!(
        "Scene(graph: {graph:?}, camera: Camera({camera}, fov: 35.0), size: (96, 72),
            lights: {{\"sun\": Light(direction: (0.1, -1, -0.1), intensity: 3.0)}}, {particles}
            meshes: {{\"meshes\": [(file: {mesh:?}, position: (0, {height_m:?}, 0))]}})"
    );
    MemoryFiles::default().with("pool.csv", format!("x,y,z\n{}", rows.collect::<String>())).with("scene.ron", scene)
}

/// How many pixels are red.
fn red(engine: &mut Engine, files: &MemoryFiles, set: &[(&str, &str)]) -> usize {
    red_within(engine, files, set, [96, 72], [0..96, 0..72])
}

/// How many pixels of a part of the picture are red.
fn red_within(
    engine: &mut Engine,
    files: &MemoryFiles,
    set: &[(&str, &str)],
    size: [u32; 2],
    [x, y]: [Range<usize>; 2],
) -> usize {
    let is_red = |[r, g, b, _]: &&[f32; 4]| *r > 0.05 && *r > 2.0 * g.max(*b);
    let light = light(engine, files, set, size);
    let width = size[0] as usize;
    y.flat_map(|row| &light[row * width..][x.clone()]).filter(is_red).count()
}

/// The picture's light, row by row.
pub fn light(engine: &mut Engine, files: &MemoryFiles, set: &[(&str, &str)], size: [u32; 2]) -> Vec<[f32; 4]> {
    let (mut sources, mut cache) = (Sources::new(), Cache::default());
    let set = set.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    let job = Job { source: PathBuf::from("scene.ron"), set, size: Some(size), ..Job::default() };
    let loaded = load(files, &mut sources, &job, &mut cache);
    let said = render_all(&loaded.diagnostics, &sources, Style::Plain);
    let mut session = Session::new(engine.gpu().clone());
    session.build(loaded.content.unwrap_or_else(|| panic!("{said}"))).unwrap();
    session.draw(Moment::default(), true).unwrap();
    let light = session.light().unwrap();
    assert_eq!(light.rgba.len(), (size[0] * size[1]) as usize);
    light.rgba
}

pub fn what_stands_in_the_liquid_is_seen_through_it(engine: &mut Engine) {
    let dry = red(engine, &files("imai2016.ron", 0.2, false), NO_FLOOR);
    assert!(dry > 300, "{dry} pixels are red where nothing is before them");
    for graph in GRAPHS {
        let pool = files(graph, 0.2, true);
        let clear = red(engine, &pool, &[("absorption", "0,0,0")]);
        let part = clear as f64 / dry as f64;
        // Water lifts what is in it towards the eye, and waves of particles bend its edges.
        assert!((0.7..1.6).contains(&part), "{graph}: {clear} pixels of {dry} are red through clear liquid");
        let murky = red(engine, &pool, &[("absorption", "20,0,0")]);
        assert!(murky * 4 < clear, "{graph}: {murky} of {clear} are red through liquid that absorbs red");
    }
}

/// Rays that end beside what stands in the liquid have met it on their way.
pub fn what_rays_pass_on_their_way_is_met(engine: &mut Engine) {
    // Where it is seen through the sides, on both sides of the pool's edge.
    let (size, middle) = ([320, 240], || [140..180, 120..180]);
    for graph in &GRAPHS[..2] {
        let found = red_within(engine, &seen(graph, POST, ASIDE, 0.02, 20), &[("absorption", "0,0,0")], size, middle());
        assert!(found > 2000, "{graph}: {found} pixels of 2400 are red");
        let none =
            red_within(engine, &seen(graph, SQUARE, ASIDE, -5.0, 20), &[("absorption", "0,0,0")], size, middle());
        assert_eq!(none, 0, "{graph}: red without the board");
    }
}

pub fn what_stands_before_the_liquid_hides_it(engine: &mut Engine) {
    let dry = red(engine, &files("imai2016.ron", 0.9, false), NO_FLOOR);
    for graph in GRAPHS {
        let above = red(engine, &files(graph, 0.9, true), &[("absorption", "20,0,0")]);
        let part = above as f64 / dry as f64;
        // Pixels of its rim are half red, and what is behind them differs.
        assert!((0.9..1.1).contains(&part), "{graph}: {above} pixels of {dry} are red above the liquid");
    }
}
