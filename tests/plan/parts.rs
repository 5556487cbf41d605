//! Parts are flattened into their users.

use meniscus::graph::value::Value;
use meniscus::plan::model::{ObjectKind, Plan};

use crate::planning::{Test, bound_path, object, pass, paths, shader};

const PART: &str = r#"Graph(
    inputs: { "source": Buffer },
    params: { "n": Int(default: 3, min: 1, max: 100) },
    let: { "wide": "2 * n" },
    resources: { "made": Buffer(items: "wide") },
    passes: [
        Compute(name: "make", shader: "constant.wgsl", each: Item("made"), bind: {"dst": "made", "n": "n"}),
    ],
    outputs: { "result": "made", "width": "wide" },
)"#;

fn items(plan: &Plan, path: &str) -> u64 {
    match &plan.objects[object(plan, path)].kind {
        ObjectKind::Buffer(buffer) => buffer.items,
        other => panic!("{path} is {other:?}"),
    }
}

/// A user of the part twice, with different parameters.
fn user() -> Test {
    let graph = r#"Graph(
        params: { "size": Int(default: 10, min: 1, max: 50) },
        resources: { "here": Buffer(items: 8), "out": Buffer(items: "one.width") },
        passes: [
            Compute(name: "fill", shader: "fill.wgsl", each: Item("here"), bind: {"dst": "here"}),
            Use(graph: "part.ron", name: "one", bind: {"source": "here"}, params: {"n": "size + 1"}),
            Use(graph: "part.ron", name: "two", bind: {"source": "here"}),
            Compute(name: "join", shader: "copy.wgsl", each: Item("out"), bind: {"src": "one.result", "dst": "out"}),
            Compute(name: "more", shader: "copy.wgsl", each: Item("here"), bind: {"src": "two.result", "dst": "here"}),
        ],
        outputs: ["out", "here"],
    )"#;
    Test::new(graph).with("graphs/part.ron", PART)
}

#[test]
fn instances_have_their_own_paths_and_sizes() {
    let plan = user().root("here").plan();
    assert_eq!(paths(&plan), ["one/make", "two/make", "join", "more"]);
    assert_eq!((items(&plan, "one.made"), items(&plan, "two.made"), items(&plan, "out")), (22, 6, 22));
    assert_eq!(shader(&plan, 0).constants, [("n".to_owned(), 11.0)]);
    assert_eq!(shader(&plan, 1).constants, [("n".to_owned(), 3.0)]);
}

#[test]
fn outputs_under_other_names_are_the_things_themselves() {
    let plan = user().root("here").plan();
    assert_eq!(bound_path(&plan, pass(&plan, "join"), "src"), "one.made");
    assert_eq!(bound_path(&plan, pass(&plan, "more"), "src"), "two.made");
    assert_eq!(plan.names["one.made"], plan.passes[pass(&plan, "one/make")].accesses[0].object);
}

#[test]
fn parameters_that_a_user_gives_are_not_shown_and_others_are() {
    let plan = user().root("here").plan();
    let shown: Vec<&str> = plan.params.iter().map(|param| param.path.as_str()).collect();
    assert!(shown.contains(&"size") && shown.contains(&"two.n"), "{shown:?}");
    assert!(!shown.contains(&"one.n"), "{shown:?}");
    let other = user().root("here").param("size", Value::Int(20)).param("two.n", Value::Int(50)).plan();
    assert_eq!((items(&other, "one.made"), items(&other, "two.made")), (42, 100));
}

#[test]
fn causes_go_through_parameters_of_parts() {
    let plan = user().root("here").plan();
    let causes = |path: &str| {
        let names = &plan.units[plan.passes[pass(&plan, path)].unit].causes.params;
        names.iter().map(String::as_str).collect::<Vec<_>>()
    };
    assert_eq!(causes("one/make"), ["size"]);
    assert_eq!(causes("two/make"), ["two.n"]);
    assert_eq!(causes("join"), ["size"]);
}

#[test]
fn a_part_in_a_part_has_the_longer_path() {
    let outer = r#"Graph(
        inputs: { "source": Buffer },
        passes: [ Use(graph: "part.ron", name: "inner", params: {"n": 4}) ],
        outputs: { "ending": "inner.result" },
    )"#;
    let graph = r#"Graph(
        resources: { "source": Buffer(items: 8), "out": Buffer(items: 8) },
        passes: [
            Compute(name: "fill", shader: "fill.wgsl", each: Item("source"), bind: {"dst": "source"}),
            Use(graph: "outer.ron", name: "outer"),
            Compute(name: "end", shader: "copy.wgsl", each: Item("out"), bind: {"src": "outer.ending", "dst": "out"}),
        ],
        outputs: ["out"],
    )"#;
    let plan = Test::new(graph).with("graphs/part.ron", PART).with("graphs/outer.ron", outer).plan();
    assert_eq!(paths(&plan), ["outer.inner/make", "end"]);
    assert_eq!(items(&plan, "outer.inner.made"), 8);
}
