//! What makes state start anew.

use meniscus::graph::value::Value;

use crate::planning::Test;

const GRAPH: &str = r#"Graph(
    params: {
        "seed": Int(default: 1, min: 0, max: 9),
        "gain": Float(default: 1.0, min: 0.0, max: 2.0),
        "items": Int(default: 8, min: 1, max: 64),
        "on": Bool(default: true),
    },
    state: { "s": Buffer(items: "items") },
    resources: { "out": Buffer(items: 8) },
    passes: [
        Clear("out"),
        If(test: "on", then: [
            Steps(rate: 60, key: "seed", passes: [
                Compute(name: "step", shader: "add.wgsl", each: Threads("floor(gain * items)"), bind: {"dst": "s"}),
            ]),
            Compute(name: "show", shader: "copy.wgsl", each: Item("out"), bind: {"src": "s", "dst": "out"}),
        ]),
    ],
    outputs: ["out"],
)"#;

fn key(changes: &[(&str, Value)]) -> Option<u128> {
    let test = changes.iter().fold(Test::new(GRAPH), |test, (path, value)| test.param(path, value.clone()));
    test.plan().steps.first().map(|steps| steps.key)
}

#[test]
fn state_starts_anew_by_its_key_and_its_declarations_and_nothing_else() {
    let plain = key(&[]);
    assert!(plain.is_some());
    assert_eq!(key(&[("gain", Value::Float(0.5))]), plain, "what only the passes see keeps it");
    assert_ne!(key(&[("seed", Value::Int(2))]), plain);
    assert_eq!(key(&[("seed", Value::Int(1))]), plain);
    assert_ne!(key(&[("items", Value::Int(9))]), plain);
    assert_eq!(key(&[("on", Value::Bool(false))]), None, "without its `If` nothing is left of it");
}
