//! `meniscus bench` from end to end: what it tells, and whether it tells two measurements apart.

use serde_json::Value;

use crate::good;
use crate::project::{Project, has_adapter};

const GRAPH: &str = r#"Graph(
    inputs: { "camera": Camera },
    params: { "times": Int(default: 2, min: 0, max: 999) },
    resources: {
        "a": Buffer(items: 64), "b": Like("a"), "picture": Texture(format: Rgba16Float, size: "viewport"),
    },
    passes: [
        Compute(name: "first", shader: "first.wgsl", each: Item("a"), bind: {"dst": "a"}),
        Repeat(times: "times", swap: [("a", "b")], passes: [
            Compute(name: "next", shader: "next.wgsl", each: Item("b"), bind: {"src": "a", "dst": "b"}),
        ]),
        Fullscreen(name: "show", shader: "show.wgsl", color: ["picture"], bind: {"src": "a"}),
    ],
    outputs: ["picture"],
)"#;
const FIRST: &str = "var<storage, read_write> dst: array<f32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3u) { dst[i.x] = f32(i.x); }";
const NEXT: &str = "var<storage, read> src: array<f32>;
var<storage, read_write> dst: array<f32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3u) { dst[i.x] = src[i.x] * 0.5; }";
const SHOW: &str = "var<storage, read> src: array<f32>;
struct Values { position: vec3f }
var<uniform> camera: Values;
@fragment fn main() -> @location(0) vec4f { return vec4f(camera.position * src[1], 1.0); }";

/// `light.ron` and the same with a hundred times the passes.
fn scenes() -> Project {
    let project = Project::empty();
    project.write("graphs/chain.ron", GRAPH);
    project.write("shaders/first.wgsl", FIRST);
    project.write("shaders/next.wgsl", NEXT);
    project.write("shaders/show.wgsl", SHOW);
    for (name, times) in [("light", 3), ("heavy", 300)] {
        let scene = format!("Scene(graph: \"chain.ron\", size: (16, 8), params: {{ \"times\": {times} }})");
        project.write(&format!("scenes/{name}.ron"), scene);
    }
    project
}

fn json(project: &Project, args: &[&str]) -> (i32, Value) {
    let run = project.run(&[&["bench", "--frames", "24", "--format", "json"], args].concat());
    let json = serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{e}: {}{}", run.stderr, run.stdout));
    (run.code, json)
}

/// What is said of each row: gpu, encode, submit.
fn verdicts(json: &Value) -> Vec<(&str, &str)> {
    let rows = json["comparison"]["rows"].as_array().unwrap();
    rows.iter().map(|row| (row["what"].as_str().unwrap(), row["verdict"].as_str().unwrap())).collect()
}

#[test]
fn what_runs_and_why_is_told() {
    if !has_adapter() {
        return;
    }
    let project = scenes();
    let (_, json) = json(&project, &["scenes/light.ron"]);
    let changes = json["changes"].as_array().unwrap();
    let of = |what: &str| changes.iter().find(|change| change["what"] == what).unwrap();
    assert_eq!((&of("nothing")["passes_run"], &of("nothing")["passes"]), (&0.into(), &5.into()));
    assert_eq!(of("time")["passes_run"], 0);
    let orbited = of("camera");
    assert_eq!(orbited["passes_run"], 1);
    for unit in orbited["units"].as_array().unwrap() {
        let shows = unit["passes"][0] == "show";
        let why: Vec<&str> = unit["why"].as_array().unwrap().iter().map(|why| why.as_str().unwrap()).collect();
        assert_eq!((unit["ran"].as_bool(), why), (Some(shows), if shows { vec!["camera.position"] } else { vec![] }));
    }
    assert!(json["passes"][0]["record"]["median_ms"].as_f64().unwrap() > 0.0);
    let table = good(project.run(&["bench", "--frames", "3", "scenes/light.ron"])).stdout;
    let said = "if nothing changes: 0 of 5 passes run\nif camera changes: 1 of 5 passes run\n  show: camera.position\n";
    assert!(table.contains(said), "{table}");
}

#[test]
fn more_work_is_told_as_slower() {
    if !has_adapter() {
        return;
    }
    let project = scenes();
    for (before, now, verdict, code) in [("light", "heavy", "slower", 1), ("heavy", "light", "faster", 0)] {
        let [before, now] = [before, now].map(|name| format!("scenes/{name}.ron"));
        let (_, measured) = json(&project, &[&before]);
        project.write("before.json", measured.to_string());
        let apart = json(&project, &[&now, "--compare", "before.json", "--deny-slower"]);
        let paired = json(&project, &[&now, "--against", &before, "--deny-slower"]);
        for (exit, json) in [apart, paired] {
            assert_eq!((exit, verdicts(&json)[1]), (code, ("encode", verdict)), "{}", json["comparison"]);
        }
    }
}

/// What is told of a scene beside itself hangs on the machine's noise; that it is what the intervals say does not.
#[test]
fn verdicts_are_what_the_intervals_say() {
    if !has_adapter() {
        return;
    }
    let project = scenes();
    let (exit, json) = json(&project, &["scenes/light.ron", "--against", "scenes/light.ron", "--deny-slower"]);
    let rows = json["comparison"]["rows"].as_array().unwrap();
    assert!(!rows.is_empty());
    let mut is_slower = false;
    for row in rows {
        let [low, high] = [0, 1].map(|i| row["ratio_95"][i].as_f64().unwrap());
        assert!(low <= high, "{row}");
        let verdict = if low > 1.0 {
            "slower"
        } else if high < 1.0 {
            "faster"
        } else {
            "no difference that can be told"
        };
        assert_eq!(row["verdict"], verdict, "{row}");
        is_slower |= verdict == "slower";
    }
    assert_eq!(exit, i32::from(is_slower));
}

#[test]
fn what_is_no_measurement_is_told() {
    let project = scenes();
    project.write("a.json", "{}");
    project.write("b.json", r#"{"version": 99}"#);
    for (file, said) in [("a.json", "it has no `version`"), ("b.json", "its version is 99"), ("c.json", "cannot read")]
    {
        let run = project.run(&["bench", "scenes/light.ron", "--compare", file]);
        assert!(run.code == 2 && run.stderr.contains(said), "{}: {}", run.code, run.stderr);
    }
}

/// What is shown is `count` times how many steps ran.
const STEPPING: &str = r#"Graph(
    inputs: { "camera": Camera },
    state: { "count": Buffer(items: 64) },
    resources: { "picture": Texture(format: Rgba16Float, size: "viewport") },
    passes: [
        Steps(rate: 120, passes: [Compute(name: "step", shader: "step.wgsl", each: Item("count"), bind: {"dst": "count"})]),
        Fullscreen(name: "show", shader: "show.wgsl", color: ["picture"], bind: {"src": "count"}),
    ],
    outputs: ["picture"],
)"#;

#[test]
fn steps_are_measured_as_they_run() {
    if !has_adapter() {
        return;
    }
    let project = scenes();
    project.write("graphs/stepping.ron", STEPPING);
    let step = FIRST.replace("= f32(i.x)", "+= 1.0");
    project.write("shaders/step.wgsl", step);
    project.write("scenes/stepping.ron", r#"Scene(graph: "stepping.ron", size: (16, 8))"#);
    let (code, json) = json(&project, &["scenes/stepping.ron"]);
    assert_eq!(code, 0, "{json}");
    let passes = json["passes"].as_array().unwrap();
    let step = passes.iter().find(|pass| pass["pass"].as_str().unwrap().starts_with("step")).unwrap();
    assert_eq!(step["record"]["samples_ms"].as_array().unwrap().len(), 24, "{step}");
    // The step, the picture, and what shows it.
    assert_eq!(json["counters"]["passes"], 3, "{}", json["counters"]);
}

#[test]
fn what_was_another_way_is_said() {
    if !has_adapter() {
        return;
    }
    let project = scenes();
    let (_, before) = json(&project, &["scenes/light.ron"]);
    project.write("before.json", before.to_string());
    let cautions = |args: &[&str]| {
        let (_, json) = json(&project, &[&["scenes/light.ron", "--compare", "before.json"], args].concat());
        json["comparison"]["cautions"]
            .as_array()
            .unwrap()
            .iter()
            .map(|c| c.as_str().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    assert!(cautions(&[]).is_empty());
    let said = cautions(&["--set", "times=5", "--policy", "share"]);
    assert_eq!(said, ["it held memory by the policy `keep`", "its `times` was 3"]);
}
