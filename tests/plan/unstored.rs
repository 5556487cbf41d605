//! Targets whose content nobody needs after the render pass that draws them.

use std::collections::BTreeSet;

use meniscus::plan::merge;
use meniscus::plan::model::Plan;
use meniscus::plan::unstored::unstored;

use crate::planning::{Test, object};

const RESOURCES: &str = r#""ms": Texture(format: Rgba16Float, size: (8, 8), samples: 4), "out": Texture(format: Rgba16Float, size: (8, 8)),
    "seen": Texture(format: Rgba16Float, size: (8, 8))"#;

fn plan(passes: &str) -> Plan {
    Test::of(RESOURCES, passes, r#""out""#).plan()
}

fn names(plan: &Plan) -> Vec<&str> {
    plan.memory.unstored.iter().map(|id| plan.objects[*id].path.as_str()).collect()
}

fn paint(name: &str, target: &str) -> String {
    format!(r#"Fullscreen(name: "{name}", shader: "paint.wgsl", samples: 4, color: [{target}]),"#)
}

const CLEARED: &str = r#"(to: "ms", clear: (0.0, 0.0, 0.0, 0.0))"#;
const ADDED: &str = r#"(to: "ms", blend: Add, resolve: "out")"#;

#[test]
fn what_is_cleared_drawn_and_resolved_in_one_render_pass_is_not_stored() {
    let plan = plan(&[paint("first", CLEARED), paint("second", ADDED)].concat());
    assert_eq!(names(&plan), ["ms"]);
    // Parted, the second would load what the first has not stored.
    assert_eq!(merge::leaders(&plan, &|id| id), [0, 0]);
    assert_eq!(unstored(&plan, &[0, 1]), BTreeSet::new());
}

#[test]
fn what_another_render_pass_loads_is_stored() {
    // Each resolves into a target of its own, so that they share no render pass.
    let first = paint("first", r#"(to: "ms", clear: (0.0, 0.0, 0.0, 0.0), resolve: "seen")"#);
    let plan = Test::of(RESOURCES, &[first, paint("second", ADDED)].concat(), r#""out", "seen""#).root("seen").plan();
    assert_eq!(merge::leaders(&plan, &|id| id), [0, 1]);
    assert_eq!(names(&plan), [""; 0]);
    assert!(!plan.memory.unstored.contains(&object(&plan, "out")), "the picture is looked at");
}

#[test]
fn what_a_shader_reads_or_a_clear_fills_is_stored() {
    let read = plan(
        r#"Fullscreen(name: "seen", shader: "paint.wgsl", color: [(to: "seen", clear: (0.0, 0.0, 0.0, 0.0))]),
           Fullscreen(name: "out", shader: "filter.wgsl", color: ["out"], bind: {"src": "seen"}),"#,
    );
    assert_eq!(names(&read), [""; 0]);
    let mut plan = plan(&[paint("first", CLEARED), paint("second", ADDED)].concat());
    // As an output it is looked at.
    plan.memory.apart.insert(object(&plan, "ms"), meniscus::plan::model::Apart::LookedAt);
    assert_eq!(unstored(&plan, &[0, 0]), BTreeSet::new());
}
