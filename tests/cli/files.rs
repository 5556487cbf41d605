//! Files with another unit, another axis up, and other names.

use super::stepping::SHOW_SUM;
use super::{Project, good, has_adapter, picture, project_of, refused};

/// Dots in metres, y up, and the same in millimetres, z up.
fn dots() -> (String, String) {
    let place = |i: u32| [i % 5, i / 5 % 7, i / 35].map(|n| f64::from(n) * 0.125);
    let (mut metres, mut millimetres) = ("x,y,z\n".to_owned(), "x,y,z\n".to_owned());
    for [x, y, z] in (0..105).map(place) {
        metres += &format!("{x},{y},{z}\n");
        millimetres += &format!("{},{},{}\n", x * 1000.0, -z * 1000.0, y * 1000.0);
    }
    (metres, millimetres)
}

#[test]
fn files_of_other_programs_are_turned_and_scaled() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    let (metres, millimetres) = dots();
    project.write("m.csv", metres);
    project.write("mm.csv", &millimetres);
    project.write("mm_1.csv", millimetres);
    let light = r#""sun": Light(direction: (-0.45, -0.8, -0.4), color: (1.0, 0.96, 0.9), intensity: 4.0)"#;
    let particles = r#""particles": (file: "mm.csv", up: Z, scale: 0.001)"#;
    project.write("mm.ron", format!("Scene(lights: {{{light}}}, particles: {{{particles}}})"));
    let draw = |source: &str, more: &[&str]| {
        let args = ["render", source, "-o", "a.png", "--size", "80x60", "--graph", "dots.ron"];
        good(project.run(&[&args[..], more].concat()));
        picture(&project, "a.png")
    };
    let expected = draw("m.csv", &[]);
    let other = ["--up", "z", "--scale", "0.001"];
    assert_eq!(draw("mm.csv", &other), expected);
    assert_eq!(draw("mm_#.csv", &other), expected, "a sequence is taken so too");
    assert_eq!(draw("mm.ron", &[]), expected, "and as a scene says it");
    assert_ne!(draw("mm.csv", &[]), expected);
    let with_sun = ["--particles", "mm.csv", "--up", "z", "--scale", "0.001"];
    assert_ne!(draw("scenes/dots.ron", &with_sun), draw("scenes/dots.ron", &["--particles", "m.csv", "--up", "z"]));
    assert_eq!(draw("scenes/dots.ron", &with_sun), draw("scenes/dots.ron", &["--particles", "m.csv"]));
    refused(
        &project,
        &["render", "scenes/dots.ron", "-o", "a.png", "--up", "z"],
        2,
        &[
            "`--up` is of a file that the command line names, and there is none",
            "in a scene, `up:` and `scale:` stand beside `file:`",
        ],
    );
    refused(&project, &["render", "m.csv", "-o", "a.png", "--scale", "-1"], 2, &["a scale is finite and above 0"]);
    refused(&project, &["render", "m.csv", "-o", "a.png", "--up", "x"], 2, &["possible values: y, z"]);
}

#[test]
fn info_tells_what_files_hold() {
    let project = Project::new();
    project.write("a_1.csv", "x,y,z,mass\n0,0,0,1.5\n1,2,-3,1.5\nnan,0,0,7\n");
    project.write("a_3.csv", "x,y,z\n0,0,0\n");
    project.write("box.obj", "mtllib box.mtl\nv 0 0 0\nv 1 0 0\nv 0 2 0\nusemtl red\nf 1 2 3\n");
    project.write("box.mtl", "newmtl red\nKd 1 0 0\n");
    let said = |files: &[&str]| good(project.run(&[&["info"], files].concat())).stdout;
    let text = said(&["a_#.csv", "box.obj"]);
    let expected = "a_#.csv: 2 files, frames 1 to 3\n  missing: 2\na_1.csv: particles\n  count: 2\n\
        \u{20}\u{20}radius: about 1.8708 m, estimated from the spacing\n\
        \u{20}\u{20}box: 0 0 -3 to 1 2 0 m, if a unit is a metre and y is up\n  attributes:\n\
        \u{20}\u{20}\u{20}\u{20}position  3 x f64  -3 to 2\n    mass      1 x f64  all 1.5\n\
        \u{20}\u{20}note: dropped 1 of 3 particles whose position is not finite\n\n\
        box.obj: mesh\n  triangles: 1, with 3 vertices, in one node\n\
        \u{20}\u{20}box: 0 0 0 to 1 2 0 m, if a unit is a metre and y is up\n  material: `red`, no pictures\n";
    assert_eq!(text, expected);
    for (file, words) in [
        ("scenes/dots.ron", ["scenes/dots.ron: scene", "particles  particles  assets/dots.csv", "size = 1.5"]),
        ("graphs/dots.ron", ["graphs/dots.ron: graph", "size   Float", "outputs: picture"]),
        ("imai2016.ron", ["imai2016.ron: graph", "environment  Texture, optional", "shapes.strays_below"]),
    ] {
        let text = said(&[file]);
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    }
    let json: serde_json::Value = serde_json::from_str(&said(&["--format", "json", "a_3.csv", "box.obj"])).unwrap();
    assert_eq!((&json[0]["particles"]["count"], &json[1]["mesh"]["materials"][0]["name"]), (&1.into(), &"red".into()));
    project.write("b.vtk", "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\nPOINTS many float\n");
    for (file, words) in [
        ("note.txt", "`note.txt` is no scene, graph, particle file, mesh or picture"),
        ("b.vtk", "`b.vtk`: line 5, column 8: expected the number of points, found `many`"),
        ("gone.glb", "there is no file `gone.glb`"),
        ("c_##.vtk", "no file is named `c_##.vtk` with a number in place of the `#`"),
    ] {
        refused(&project, &["info", file], 2, &[words]);
    }
}

#[test]
fn another_graph_leaves_out_what_the_scene_says_for_its_own() {
    if !has_adapter() {
        return;
    }
    let project = Project::new();
    project.write(
        "graphs/other.ron",
        project.text("graphs/dots.ron").replace("\"size\"", "\"extent\"").replace("size *", "extent *"),
    );
    let render = ["render", "scenes/dots.ron", "-o", "a.png", "--size", "80x60", "--graph"];
    let run = good(project.run(&[&render[..], &["graphs/other.ron"]].concat()));
    for words in [
        "warning[unknown-name]: there is no parameter `size` in `graphs/other.ron`: the scene's value is left out",
        "scenes/dots.ron:16",
        "the scene says it for its own graph, and `--graph` names another",
    ] {
        assert!(run.stderr.contains(words), "{}", run.stderr);
    }
    picture(&project, "a.png");
    // For its own graph it stays a mistake, and so does what is typed.
    project.edit("scenes/dots.ron", "\"size\": 1.5", "\"siz\": 1.5");
    let graph = project
        .text("scenes/dots.ron")
        .lines()
        .find_map(|line| line.trim().strip_prefix("graph: \"")?.strip_suffix("\",").map(str::to_owned));
    refused(&project, &["render", "scenes/dots.ron", "-o", "b.png"], 1, &["there is no parameter `siz`"]);
    refused(&project, &[&render[..], &[&graph.unwrap()]].concat(), 1, &["there is no parameter `siz`"]);
    refused(
        &project,
        &[&render[..], &["graphs/other.ron", "--set", "siz=1"]].concat(),
        2,
        &["there is no parameter `siz`"],
    );
}

const COUNTS: &str = "struct Counts { particles_count: u32, foam_count: u32, foam_radius: f32 }\n\
    var<uniform> told: Counts;\n\
    var<storage, read_write> sum: array<f32>;\n\
    var<storage, read> foam_mass: array<f32>;\n\
    @compute @workgroup_size(1) fn main() {\n\
    sum[0] = f32(told.particles_count);\n sum[1] = f32(told.foam_count);\n sum[2] = foam_mass[0];\n\
    sum[3] = told.foam_radius;\n }";

/// Liquid in frames 0 to 3, foam in frames 2 and 3: frame n has n + 1 particles.
fn liquid_and_foam() -> Project {
    let declarations = "inputs: {\"particles\": Particles(attributes: [\"position\"]), \
        \"foam\": Particles(attributes: [\"position\", \"mass\"])}, resources: {PICTURE, \"sum\": Buffer(items: 4)},";
    let passes = "Compute(shader: \"sum.wgsl\", groups: 1),";
    let project = project_of(passes, declarations, &[("sum", COUNTS), ("show", SHOW_SUM)]);
    let rows = |n: u32| (0..=n).map(|i| format!("{i},0,0,{n}.5\n")).collect::<String>();
    for n in 0..4 {
        project.write(&format!("liquid_{n}.csv"), format!("x,y,z,mass\n{}", rows(n)));
    }
    for n in 2..4 {
        project.write(&format!("foam_{n}.csv"), format!("x,y,z,mass\n{}", rows(n)));
    }
    project
}

#[test]
fn foam_that_begins_later_is_empty_until_then() {
    if !has_adapter() {
        return;
    }
    let project = liquid_and_foam();
    let scene = |frames: &str, liquid: &str| {
        let foam = format!("\"foam\": (file: \"../foam_#.csv\"{frames})");
        let liquid = format!("\"particles\": (file: \"../{liquid}\", radius: 0.1)");
        project.write(
            "scenes/it.ron",
            format!("Scene(graph: \"it.ron\", size: (16, 8), particles: {{{liquid}, {foam}}})"),
        );
    };
    let counts = |more: &[&str]| {
        let render = ["render", "scenes/it.ron", "-o", "a_#.png", "--dump", "sum=s.csv"];
        let run = good(project.run(&[&render[..], more].concat()));
        let text = project.text("s.csv");
        let numbers: Vec<f32> = text.lines().skip(1).take(3).map(|line| line.parse().unwrap()).collect();
        let radius: f32 = text.lines().nth(4).unwrap().parse().unwrap();
        assert!((radius - 0.5).abs() < 0.01, "that of the first file, also before it: {text}");
        (numbers, run.stderr)
    };
    let begins = "note[asset-note]: `../foam_#.csv` begins with frame 2: until then it is empty";
    for frames in ["", ", frames: (0, 3)", ", frames: (2, 3)"] {
        scene(frames, "liquid_#.csv");
        // At 25 frames a second.
        for (frame, time, expected) in [("0", "0", [1.0, 0.0]), ("1", "0.04", [2.0, 0.0]), ("2", "0.08", [3.0, 3.0])] {
            for when in [["--frame", frame], ["--time", time]] {
                let (found, said) = counts(&when);
                assert_eq!(found[..2], expected, "{frames} {when:?}");
                assert_eq!(said.matches(begins).count(), usize::from(frame != "2"), "{said}");
            }
        }
        // From none to some while it plays.
        let (found, said) = counts(&["--frames", "0..3"]);
        assert_eq!(found, [4.0, 4.0, 3.5], "{frames}");
        assert_eq!(said.matches(begins).count(), 1, "{said}");
    }
    // What stands in the place of the liquid makes the scene's numbers as that did.
    scene("", "gone_#.csv");
    assert_eq!(
        counts(&["--particles", "particles=liquid_#.csv", "--radius", "0.5", "--frame", "1"]).0[..2],
        [2.0, 0.0]
    );
    // Foam that ends sooner stays, and that is told.
    std::fs::remove_file(project.path("foam_3.csv")).unwrap();
    scene("", "liquid_#.csv");
    let held = "`foam_#.csv`: frame 3 is beyond 2 to 2: 2 is shown";
    for when in [["--frame", "3"], ["--frames", "1..3"], ["--time", "0.12"]] {
        let (found, said) = counts(&when);
        assert_eq!(found, [4.0, 3.0, 2.5], "{when:?}");
        assert_eq!(said.matches(held).count(), 1, "{said}");
    }
    assert!(!counts(&["--time", "9"]).1.contains("beyond"), "the scene's end");
    // One for the liquid and one for the foam.
    assert_eq!(counts(&["--frame", "9"]).1.matches("frame 9 is beyond").count(), 2);
}
