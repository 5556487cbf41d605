//! What is said when a sound graph meets a scene, a parameter or a device that does not fit: each
//! golden in `requests/` is the whole text.

use std::collections::BTreeMap;

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::graph::value::Value;
use meniscus::plan::{instantiate, model::InputInfo, model::Policy, model::Request};
use meniscus::program;
use wgpu_types::{Features, Limits};

use super::cases::shared;
use crate::golden;

const GRAPH: &str = r#"Graph(
    inputs: { "particles": Particles(attributes: ["position", "velocity", "color?"]) },
    params: { "edge": Int(default: 64, min: 1, max: 8192, unit: "px") },
    resources: {
        "speeds": Buffer(items: "count(particles)"),
        "color":  Texture(format: Rgba32Float, size: "edge"),
    },
    passes: [
        Compute(shader: "speed.wgsl", each: Item("particles")),
        Draw(shader: "triangle.wgsl", vertices: 3, instances: "count(speeds)",
             color: [(to: "color", clear: 0.0, blend: Add)]),
    ],
    outputs: ["color", "speeds"],
)
"#;

const SPEED: &str = r#"#import "lib/packed.wgsl"
#import "lib/dispatch.wgsl"
var<storage> particles_velocity: array<Packed3>;
var<storage, read_write> speeds: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 64u);
    if i < arrayLength(&speeds) {
        speeds[i] = particles_velocity[i].x;
    }
}
"#;

/// A scene and a device on which everything is fine.
fn request() -> Request {
    let particles = InputInfo::Particles {
        count: 1000,
        radius: 0.025,
        min: [0.0; 3],
        max: [1.0; 3],
        attributes: vec![("position".into(), 3), ("velocity".into(), 3)],
    };
    Request {
        viewport: [640, 480],
        params: BTreeMap::new(),
        inputs: [("particles".to_owned(), particles)].into(),
        capacities: BTreeMap::new(),
        roots: Vec::new(),
        stats: false,
        memory: Default::default(),
        features: Features::FLOAT32_BLENDABLE,
        limits: Limits::default(),
    }
}

fn attributes(request: &mut Request, wanted: &[(&str, u32)]) {
    if let Some(InputInfo::Particles { attributes, .. }) = request.inputs.get_mut("particles") {
        *attributes = wanted.iter().map(|(name, n)| ((*name).to_owned(), *n)).collect();
    }
}

/// Plans the graph and gives back what is said.
fn said(change: impl FnOnce(&mut Request)) -> String {
    let files = shared().with("graph.ron", GRAPH).with("speed.wgsl", SPEED);
    let mut sources = Sources::new();
    let loaded = program::load(&files, &mut sources, "graph.ron", None);
    let shown = render_all(&loaded.diagnostics, &sources, Style::Plain);
    let program = loaded.program.unwrap_or_else(|| panic!("{shown}"));
    let mut request = request();
    change(&mut request);
    let diagnostics = match instantiate(&program, &request) {
        Ok(plan) => plan.warnings,
        Err(diagnostics) => diagnostics,
    };
    render_all(&diagnostics, &sources, Style::Plain)
}

fn expect(name: &str, change: impl FnOnce(&mut Request)) {
    golden::golden(format!("tests/check/requests/{name}.txt"), &said(change));
}

#[test]
fn a_fitting_request_is_planned_without_a_word() {
    assert_eq!(said(|_| {}), "");
}

#[test]
fn an_attribute_that_the_particles_lack() {
    expect("absent_attribute", |r| attributes(r, &[("position", 3), ("mass", 1)]));
}

#[test]
fn an_attribute_with_another_number_of_components() {
    expect("attribute_components", |r| attributes(r, &[("position", 3), ("velocity", 2)]));
}

#[test]
fn a_scene_without_the_input() {
    expect("missing_input", |r| r.inputs.clear());
}

#[test]
fn an_input_of_another_kind() {
    expect("wrong_kind", |r| _ = r.inputs.insert("particles".into(), InputInfo::Camera));
}

#[test]
fn a_parameter_that_the_graph_lacks() {
    expect("unknown_parameter", |r| _ = r.params.insert("egde".into(), Value::Int(4)));
}

#[test]
fn a_parameter_of_a_part_that_is_not_there() {
    expect("unknown_parameter_of_part", |r| _ = r.params.insert("part.edge".into(), Value::Int(4)));
}

#[test]
fn a_parameter_outside_its_range() {
    expect("parameter_range", |r| _ = r.params.insert("edge".into(), Value::Int(0)));
}

#[test]
fn a_parameter_of_another_kind() {
    expect("parameter_kind", |r| _ = r.params.insert("edge".into(), Value::Float(2.5)));
}

#[test]
fn a_resource_to_dump_that_is_not_there() {
    expect("unknown_root", |r| r.roots.push("speds".into()));
}

#[test]
fn a_device_with_too_small_limits() {
    expect("device_limit", |r| r.limits.max_texture_dimension_2d = 32);
}

#[test]
fn a_parameter_too_large_for_the_device() {
    expect("parameter_too_large", |r| {
        r.params.insert("edge".into(), Value::Int(4096));
        r.limits.max_texture_dimension_2d = 1000;
    });
}

#[test]
fn a_device_without_the_feature() {
    expect("device_feature", |r| r.features = Features::empty());
}

#[test]
fn more_particles_than_the_device_can_bind() {
    expect("too_many_particles", |r| {
        if let Some(InputInfo::Particles { count, .. }) = r.inputs.get_mut("particles") {
            *count = 100_000_000;
        }
        r.roots.push("speeds".into());
    });
}

#[test]
fn a_budget_that_no_policy_keeps_to() {
    expect("memory_budget", |r| r.memory.budget = Some(50_000));
}

#[test]
fn a_budget_that_the_policy_asked_for_does_not_keep_to() {
    expect("memory_budget_of_policy", |r| {
        r.memory.policy = Some(Policy::Keep);
        (r.memory.budget, r.memory.elsewhere) = (Some(100_000), 30_000);
    });
}
