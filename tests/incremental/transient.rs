//! Targets that are never stored: the picture is the same, and the device is told.

use meniscus::engine::{Engine, Frame, Policy, Runner, StepInfo};
use meniscus::graph::value::Value;
use meniscus::plan::model::{Cut, ObjectRef, Plan};
use wgpu::TextureUsages;

use crate::planning::{Test, object, pass};

/// Two draws into one target of four samples, which the second resolves.
fn plan() -> Plan {
    let graph = r#"Graph(
        resources: { "ms": Texture(format: Rgba16Float, size: (8, 8), samples: 4),
                     "depth": Texture(format: Depth32Float, size: (8, 8), samples: 4), "out": Texture(format: Rgba16Float, size: (8, 8)) },
        passes: [
            Fullscreen(name: "first", shader: "paint.wgsl", samples: 4, depth: Depth(to: "depth", compare: Always, write: true, clear: 0.0),
                       color: [(to: "ms", clear: (0.0, 0.0, 0.0, 0.0))]),
            Fullscreen(name: "second", shader: "paint.wgsl", samples: 4, depth: Test("depth"),
                       color: [(to: "ms", blend: Add, resolve: "out")]),
        ],
        outputs: ["out"],
    )"#;
    Test::new(graph).plan()
}

fn drawn(engine: &mut Engine, plan: Plan, only: Option<&[bool]>) -> (Runner, Vec<u8>) {
    let out = plan.outputs[0].object;
    let mut runner = engine.prepare(plan, None).unwrap_or_else(|refused| panic!("{:#?}", refused.diagnostics));
    let live = |_: &str, _: Option<&StepInfo>| None::<Value>;
    for number in 0..2 {
        runner.run_all(number > 0);
        let frame = Frame { time: 1.0, delta: 0.1, frame: number, steps: &[], live: &live, only };
        runner.run(engine, &frame).unwrap_or_else(|d| panic!("{d:#?}"));
        runner.finish(engine).unwrap();
    }
    let bytes = runner.read_texture(engine, out, 0, None).unwrap().bytes;
    (runner, bytes)
}

fn is_transient(runner: &Runner, name: &str) -> bool {
    let texture = runner.texture(ObjectRef::Fixed(object(runner.plan(), name))).unwrap();
    texture.usage().contains(TextureUsages::TRANSIENT_ATTACHMENT)
}

pub fn pictures_are_those_of_what_is_stored(engine: &mut Engine) {
    assert_eq!(plan().memory.unstored, [object(&plan(), "ms"), object(&plan(), "depth")].into());
    let (runner, bytes) = drawn(engine, plan(), None);
    let knows = engine.gpu().info().transient_saves_memory.is_some();
    assert_eq!([is_transient(&runner, "ms"), is_transient(&runner, "depth")], [knows; 2]);
    // 2 as a half, four times a texel.
    assert!(bytes == [0x00, 0x40].repeat(4 * 64));
    let mut stored = plan();
    stored.memory.unstored.clear();
    let (runner, same) = drawn(engine, stored, None);
    assert!(!is_transient(&runner, "ms") && same == bytes);
    let held = |plan: Plan, engine: &mut Engine| drawn(engine, plan, None).0.memory_bytes();
    let saves = engine.gpu().info().transient_saves_memory == Some(true);
    let bytes = if saves { 8 * 8 * 8 } else { 8 * 8 * (8 + 4 * 8 + 4 * 4) };
    assert_eq!(held(plan(), engine), bytes);
}

pub fn a_render_pass_that_is_parted_stores(engine: &mut Engine) {
    // A cut where a plan would make none: what the first draws must be there for the second.
    let mut parted = plan();
    parted.memory.cuts = vec![Cut { before: pass(&parted, "second"), gives: Vec::new(), makes: Vec::new() }];
    parted.memory.policy = Policy::Smallest;
    let (runner, bytes) = drawn(engine, parted, None);
    assert!(!is_transient(&runner, "ms"));
    assert!(bytes == [0x00, 0x40].repeat(4 * 64));
}

pub fn a_draw_alone_of_its_render_pass_clears(engine: &mut Engine) {
    // What the first would have drawn is nowhere, and wgpu refuses nothing.
    let (_, bytes) = drawn(engine, plan(), Some(&[false, true]));
    assert!(bytes == [0x00, 0x3c].repeat(4 * 64));
}
