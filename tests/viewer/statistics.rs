//! Statistics in the window: nothing runs for them until somebody looks, and they follow what is turned.

use meniscus::graph::value::Value;
use meniscus::viewer::action::Action;

use crate::desk::Desk;
use crate::project::{Project, has_adapter};

const GRAPH: &str = "graphs/dots.ron";
const MEASURE: &str = "
struct Settings { disc_m: f32 }
var<uniform> settings: Settings;
var<storage, read_write> areas: array<f32>;
@compute @workgroup_size(64) fn measure(@builtin(global_invocation_id) i: vec3u) {
    if i.x < arrayLength(&areas) { areas[i.x] = settings.disc_m * settings.disc_m; }
}
";

fn project() -> Project {
    let project = Project::new();
    project.write("shaders/dots/measure.wgsl", MEASURE);
    project.edit(
        GRAPH,
        "    passes: [\n",
        "    passes: [\n        Compute(shader: \"dots/measure.wgsl\", each: Item(\"areas\")),\n",
    );
    project.edit(
        GRAPH,
        "    resources: {\n",
        "    resources: {\n        \"areas\": Buffer(items: \"particles.count\"),\n",
    );
    let stats = "    stats: { \"all\": \"count(particles)\", \"largest\": \"max(areas)\" },\n    outputs:";
    project.edit(GRAPH, "    outputs:", stats);
    project
}

fn value(desk: &Desk, path: &str) -> Option<f64> {
    desk.core.state.statistics.iter().find(|statistic| statistic.path == path)?.value
}

fn is_culled(desk: &Desk) -> bool {
    desk.core.plan().unwrap().culled.iter().any(|culled| culled.path == "measure")
}

#[test]
fn they_are_counted_while_somebody_looks() {
    if !has_adapter() {
        return;
    }
    let mut desk = Desk::of(project());
    let first = desk.picture();
    assert!(is_culled(&desk) && desk.core.state.statistics.is_empty());

    desk.core.act(Action::Count(true));
    desk.until("statistics", |core| core.state.statistics.iter().any(|s| s.path == "largest" && s.value.is_some()));
    let count = desk.core.particles()[0].1 as f64;
    assert!(!is_culled(&desk) && value(&desk, "all") == Some(count));
    // In the shader's precision: 1.5 radii of 0.02 m.
    let area = |radii: f32| f64::from((radii * 0.02) * (radii * 0.02));
    let near = |found: Option<f64>, wanted: f64| found.is_some_and(|found| (found / wanted - 1.0).abs() < 1e-6);
    assert!(near(value(&desk, "largest"), area(1.5)), "{:?}", desk.core.state.statistics);
    assert!(desk.picture() == first, "counting shows");

    desk.core.act(Action::Set { path: "size".into(), value: Some(Value::Float(3.0)) });
    desk.rest();
    assert!(near(value(&desk, "largest"), area(3.0)), "{:?}", desk.core.state.statistics);

    desk.core.act(Action::Count(false));
    desk.rest();
    assert!(is_culled(&desk) && desk.core.state.statistics.is_empty());
}
