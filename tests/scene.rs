//! Scene files: what is read, and the whole text of what is said about mistakes.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::graph::value::Value;
use meniscus::scene::{self, Scene};

#[path = "support/golden.rs"]
mod golden;

fn read(path: &Path, text: &str) -> (Option<Scene>, String) {
    let (mut sources, mut found) = (Sources::new(), Diagnostics::new());
    let scene = scene::read(path, text.as_bytes(), &mut sources, &mut found);
    (scene, render_all(&found, &sources, Style::Plain))
}

#[test]
fn every_mistake_of_a_file_is_told_at_its_place() {
    let folder = golden::root().join("tests/scene/cases");
    let entries = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let mut cases: Vec<_> = entries.filter(|path| path.extension().is_some_and(|end| end == "ron")).collect();
    cases.sort();
    assert!(cases.len() >= 7);
    let mut failures = String::new();
    for case in cases {
        let name = case.file_name().unwrap().to_str().unwrap();
        let (_, said) = read(Path::new(name), &std::fs::read_to_string(&case).unwrap());
        assert!(said.contains("error"), "{name} has no error");
        let expected = Path::new("tests/scene/cases").join(name).with_extension("txt");
        failures += &golden::compare(&expected, &said).err().unwrap_or_default();
    }
    assert!(failures.is_empty(), "{failures}");
}

#[test]
fn a_scene_says_all_that_a_picture_needs() {
    let text = r#"Scene(
        about: "a scene",
        graph: "a.ron",
        camera: Camera(eye: (0, 1, 5), target: (0.0, 0.5, 0.0), fov: 30.0, near: 0.1),
        lights: { "sun": Light(direction: (0.0, -2.0, 0.0), color: (1.0, 0.9, 0.8), intensity: 3.0) },
        environment: "assets/a.hdr",
        particles: { "drops": (file: "a.bgeo", radius: 0.025), "mist": "b.ply" },
        tables: { "waves": [(length: 1.5, way: (1.0, 0.0)), {"length": 2, "way": (0, 1)}] },
        textures: { "map": "map.png" },
        params: { "iterations": 5, "part.on": true, "kind": fast, "other": "slow", "tint": (0.1, 0.2, 0.3) },
        present: { "exposure": 1.5 },
        size: (640, 480),
    )"#;
    let (scene, said) = read(Path::new("a.ron"), text);
    assert_eq!(said, "");
    let scene = scene.unwrap();
    assert_eq!(scene.about.as_deref(), Some("a scene"));
    assert_eq!(scene.graph.unwrap().value, "a.ron");
    let camera = scene.camera.unwrap().value;
    assert_eq!((camera.eye.to_array(), camera.fov_degrees, camera.near_m), ([0.0, 1.0, 5.0], 30.0, Some(0.1)));
    assert_eq!(scene.lights[0].value.field("direction"), Some(Value::vec([0.0, -1.0, 0.0])));
    let files: Vec<_> = scene.particles.iter().map(|p| p.value.file.value.as_str()).collect();
    assert_eq!(files, ["a.bgeo", "b.ply"]);
    assert_eq!(scene.particles[0].value.radius_m.as_ref().map(|r| r.value), Some(0.025));
    let textures: Vec<_> = scene.textures.iter().map(|t| (t.name.value.as_str(), t.value.value.as_str())).collect();
    assert_eq!(textures, [("map", "map.png"), ("environment", "assets/a.hdr")]);
    assert_eq!(scene.tables[0].value[1]["length"], Value::Int(2));
    assert_eq!(scene.tables[0].value[0]["way"], Value::vec([1.0, 0.0]));
    let params: Vec<_> = scene.params.iter().map(|p| p.value.clone()).collect();
    let word = |w: &str| Value::Word(w.into());
    assert_eq!(params, [Value::Int(5), Value::Bool(true), word("fast"), word("slow"), Value::vec([0.1, 0.2, 0.3])]);
    assert_eq!(scene.size, Some([640, 480]));
}

#[test]
fn bytes_that_are_no_text_are_told() {
    let (mut sources, mut found) = (Sources::new(), Diagnostics::new());
    let scene = scene::read(Path::new("a.ron"), b"Scene(\xff)", &mut sources, &mut found);
    assert!(scene.is_none() && found.has_errors());
    let (scene, said) = read(Path::new("a.ron"), "");
    assert!(scene.is_none() && said.contains("error"), "{said}");
}
