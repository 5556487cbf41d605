//! `meniscus test` from end to end: declared cases that pass, that fail, and that are wrong.

use crate::golden::golden;
use crate::good;
use crate::project::{Project, Run, has_adapter};

const GRAPH: &str = r#"Graph(
    params: { "least": Int(default: 24, min: 0, max: 64), "grey": Float(default: 0.25, min: 0.0, max: 1.0) },
    resources: { "found": Counted(capacity: 64), "picture": Texture(format: Rgba16Float, size: "viewport") },
    passes: [
        Clear(of: "found"),
        Compute(shader: "find.wgsl", groups: 1),
        Fullscreen(shader: "show.wgsl", color: ["picture"]),
    ],
    outputs: ["picture", "found"],
    stats: { "room_used": "count(found) / capacity(found)", "mean": "mean(found)", "none": "1 / (count(found) - 40)" },
)"#;
const FIND: &str = "struct Found { count: atomic<u32>, items: array<u32> }
var<storage, read_write> found: Found;
var<uniform> least: u32;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3u) {
    if i.x >= least { found.items[atomicAdd(&found.count, 1u)] = 7u; }
}";
const SHOW: &str = "var<uniform> grey: f32;
@fragment fn main() -> @location(0) vec4f { return vec4f(vec3f(grey), 1.0); }";

fn project(cases: &str) -> Project {
    let project = Project::empty();
    project.write("graphs/found.ron", GRAPH);
    project.write("shaders/find.wgsl", FIND);
    project.write("shaders/show.wgsl", SHOW);
    project.write("scenes/found.ron", "Scene(graph: \"found.ron\", size: (64, 64))");
    project.write("tests/cases.ron", format!("Tests(cases: {{\n{cases}\n}})\n"));
    project
}

/// The error stream of a run that ends so is a golden.
fn expect(name: &str, project: &Project, args: &[&str], code: i32) -> Run {
    let run = project.run(&[&["test"], args].concat());
    assert_eq!((run.code, run.stdout.as_str()), (code, ""), "{args:?} said:\n{}", run.stderr);
    golden(format!("tests/cli/texts/{name}.txt"), &run.stderr);
    run
}

#[test]
fn what_comes_out_is_held_against_what_is_expected() {
    if !has_adapter() {
        return;
    }
    let project = project(
        r#"    "as it is":     (scene: "found.ron", stats: {"room_used": 0.625, "mean": (min: 7, max: 7)}),
    "more of them": (scene: "found.ron", params: {"least": 0}, stats: {"room_used": 1}),
    "too many":     (scene: "found.ron", params: {"least": 32}, stats: {"room_used": (max: 0.49), "mean": (min: 6.5)}),
    "misspelt":     (scene: "found.ron", stats: {"room_use": (min: 0.0)}),
    "no number":    (scene: "found.ron", stats: {"none": (min: 0.0)}),"#,
    );
    expect("test_statistics", &project, &[], 1);
    good(project.run(&["test", "tests/cases.ron", "--case", "as it is", "--case", "more"]));
}

/// The planted fault is a picture of another parameter.
#[test]
fn pictures_are_compared() {
    if !has_adapter() {
        return;
    }
    let project = project(r#"    "grey": (scene: "found.ron", size: (8, 6), picture: "expected/grey.png"),"#);
    expect("test_no_picture", &project, &[], 1);
    good(project.run(&["test", "--bless"]));
    assert!(project.files().contains(&"tests/expected/grey.png".to_owned()), "{:?}", project.files());
    good(project.run(&["test"]));
    // 0.2501 is shown by the same eight bits, 0.3 is not.
    project.edit("tests/cases.ron", "size: (8, 6),", "size: (8, 6), params: {\"grey\": 0.2501},");
    good(project.run(&["test"]));
    project.edit("tests/cases.ron", "0.2501", "0.3");
    expect("test_other_picture", &project, &[], 1);
    project.edit("tests/cases.ron", "picture:", "tolerance: 0.1, picture:");
    good(project.run(&["test"]));
    project.edit("tests/cases.ron", "(8, 6)", "(8, 8)");
    expect("test_other_size", &project, &[], 1);
    project.write("tests/expected/grey.png", "no picture");
    let run = project.run(&["test"]);
    assert!(run.code == 1 && run.stderr.contains("is no picture"), "{}", run.stderr);
}

/// A case that cannot be drawn fails by what is wrong with it, and the others are drawn.
#[test]
fn a_case_that_cannot_be_drawn_fails() {
    if !has_adapter() {
        return;
    }
    let project = project(
        r#"    "wrong": (scene: "found.ron", params: {"leest": 1}, stats: {"room_used": 1}),
    "right": (scene: "found.ron", stats: {"room_used": 0.625}),"#,
    );
    let run = project.run(&["test"]);
    assert!(run.stderr.contains("did you mean `least`?"), "{}", run.stderr);
    assert!(run.code != 0 && run.stderr.contains("1 of 2 cases passed"), "{}", run.stderr);
}

/// No device is asked for.
#[test]
fn files_that_are_wrong_are_told_before_anything_is_drawn() {
    let project = project(
        r#"    "nothing": (scene: "found.ron"),
    "both":    (scene: "found.ron", frame: 1, time: 0.5, stats: {"a": 1}),
    "bounds":  (scene: "found.ron", stats: {"a": (min: 2, max: 1), "b": (least: 2), "c": "no"}),
    "picture": (scene: "nowhere.ron", size: (0, 4), picture: "a.gif", tolerance: 2, extra: 1),"#,
    );
    expect("test_wrong_file", &project, &[], 1);
    for (args, code, words) in [
        (&["test", "none.ron"][..], 2, "none.ron"),
        (&["test", "scenes/found.ron"], 1, "expected `Tests(cases:"),
        (&["test", "--case", "x"], 1, "both"),
    ] {
        let run = project.run(args);
        assert_eq!(run.code, code, "{args:?} said:\n{}", run.stderr);
        assert!(run.stderr.contains(words), "{args:?} said:\n{}", run.stderr);
    }
    let empty = Project::empty();
    let run = empty.run(&["test"]);
    assert!(run.code == 2 && run.stderr.contains("no file below `tests` begins with `Tests(`"), "{}", run.stderr);
}

/// What this repository declares.
#[test]
fn shipped_cases_pass() {
    if !has_adapter() {
        return;
    }
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_meniscus"));
    let run = Run::from(command.args(["test"]).current_dir(root).env("NO_COLOR", "1").output().unwrap());
    assert!(run.code == 0 && run.stderr.contains("cases passed"), "{}", run.stderr);
}
