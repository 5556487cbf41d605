//! Files with another unit, another axis up, and other names.

use super::{Project, good, has_adapter, picture, refused};

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
