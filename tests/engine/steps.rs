//! `Steps`, state that swaps, live uniforms.

use std::cell::RefCell;

use meniscus::engine::{Engine, Frame, StepInfo};
use meniscus::graph::expr::{Expr, ExprKind};
use meniscus::graph::value::Value;
use meniscus::plan::model::*;
use meniscus::shader::reflect::{Scalar, Type};

use crate::support::*;

fn live(name: &str) -> UniformValue {
    UniformValue::Live(Expr { kind: ExprKind::Name(name.into()), span: SPAN })
}

fn member(name: &str, offset: u32, ty: Type, value: UniformValue) -> UniformMember {
    UniformMember { name: name.into(), offset, ty, value }
}

const F32: Type = Type::Scalar(Scalar::F32);
const U32: Type = Type::Scalar(Scalar::U32);

pub fn uniforms_are_packed_where_the_shader_has_them(engine: &mut Engine) {
    const WGSL: &str = "
struct In { a: f32, b: vec3<f32>, c: u32, m: mat3x3<f32>, eye: vec3<f32>, time: f32 }
var<uniform> given: In;
var<storage, read_write> out: array<f32>;
@compute @workgroup_size(1) fn main() {
    out[0] = given.a; out[1] = given.b.z; out[2] = f32(given.c);
    out[3] = given.m[2][1]; out[4] = given.eye.y; out[5] = given.time;
}";
    let mut plan = new_plan();
    let out = plan.buffer("out", 6);
    let vec3 = || Type::Vector { components: 3, scalar: Scalar::F32 };
    let known = |v| UniformValue::Known(v);
    let m = Type::Matrix { columns: 3, rows: 3, scalar: Scalar::F32 };
    plan.uniforms.push(UniformBlock {
        size: 112,
        members: vec![
            member("a", 0, F32, known(Value::Int(4))),
            member("b", 16, vec3(), known(Value::vec([1.0, 2.0, 3.0]))),
            member("c", 28, U32, known(Value::Bool(true))),
            member("m", 32, m, known(Value::vec((0..9).map(f64::from)))),
            member("eye", 80, vec3(), live("camera.position")),
            member("time", 92, F32, live("time")),
        ],
    });
    let bound = [("given", Bound::Uniform { block: 0 }), ("out", storage(out))];
    plan.compute("read", WGSL, &bound, Dispatch::Groups([1, 1, 1]));
    let mut runner = prepare(engine, plan);
    for frame in 0..3u64 {
        let height = frame as f64;
        let live = |name: &str, _: Option<&StepInfo>| {
            (name == "camera.position").then(|| Value::vec([0.0, 10.0 + height, 0.0]))
        };
        let now = Frame { time: 0.5 * height, delta: 0.5, frame, steps: &[], live: &live, only: None };
        runner.run(engine, &now).unwrap();
        let out: Vec<f32> = words(engine, &runner, out).into_iter().map(f32::from_bits).collect();
        assert_eq!(out, [4.0, 3.0, 1.0, 7.0, 10.0 + frame as f32, 0.5 * frame as f32]);
    }
    let failed = runner.run(engine, &frame()).unwrap_err();
    assert!(failed.iter().any(|d| d.message.contains("`eye` of `read`")), "{failed:?}");
}

/// Two states that swap: each step reads the older and writes the newer one, which is the older
/// plus the step's number; a pass afterwards copies the newest out.
fn stepping() -> (Plan, ObjectId) {
    const STEP: &str = "
struct In { step: u32, time: f32 }
var<uniform> now: In;
var<storage, read> old: array<f32>;
var<storage, read_write> fresh: array<f32>;
@compute @workgroup_size(1) fn main() {
    fresh[0] = old[0] + f32(now.step + 1u);
    fresh[1] = old[1] + now.time;
    fresh[2] = old[2] + 1.0;
}";
    const COPY: &str = "
struct In { time: f32 }
var<uniform> now: In;
var<storage, read> newest: array<f32>;
var<storage, read_write> out: array<f32>;
@compute @workgroup_size(1) fn main() {
    for (var i = 0u; i < 3u; i++) { out[i] = newest[i]; }
    out[3] = now.time;
}";
    let mut plan = new_plan();
    let (a, b, out) = (plan.buffer("a", 4), plan.buffer("b", 4), plan.buffer("out", 4));
    plan.objects[a].origin = Origin::State(0);
    plan.objects[b].origin = Origin::State(0);
    plan.rings.push(Ring { objects: vec![a, b], turn: 1, steps: 0 });
    let members = vec![member("step", 0, U32, live("step")), member("time", 4, F32, live("time"))];
    plan.uniforms.push(UniformBlock { size: 8, members });
    plan.uniforms.push(UniformBlock { size: 4, members: vec![member("time", 0, F32, live("time"))] });
    let ring = |index, writable| Bound::Storage { buffer: ObjectRef::Ring { ring: 0, index }, writable };
    let bound = [("now", Bound::Uniform { block: 0 }), ("old", ring(0, false)), ("fresh", ring(1, true))];
    let step = plan.compute("sim/step", STEP, &bound, Dispatch::Groups([1, 1, 1]));
    plan.passes[step].steps = Some(0);
    plan.steps.push(Steps {
        path: "sim".into(),
        rate: Some(4.0),
        passes: 0..1,
        asked: None,
        key: 1,
        state: vec![a, b],
    });
    let bound = [("now", Bound::Uniform { block: 1 }), ("newest", ring(0, false)), ("out", storage(out))];
    plan.compute("copy", COPY, &bound, Dispatch::Groups([1, 1, 1]));
    (plan, out)
}

fn step(engine: &mut Engine, runner: &mut meniscus::engine::Runner, time: f64, steps: u32) {
    let steps = [steps];
    let now = Frame { time, steps: &steps, ..frame() };
    runner.run(engine, &now).unwrap();
}

fn floats(engine: &Engine, runner: &meniscus::engine::Runner, object: ObjectId) -> Vec<f32> {
    words(engine, runner, object).into_iter().map(f32::from_bits).collect()
}

pub fn state_swaps_over_steps_and_frames(engine: &mut Engine) {
    let (plan, out) = stepping();
    let mut runner = prepare(engine, plan);
    let mut done = 0;
    for (frame, steps) in [1, 0, 3, 2, 1].into_iter().enumerate() {
        done += steps;
        let time = frame as f64 * 100.0;
        step(engine, &mut runner, time, steps);
        assert_eq!(runner.steps_done(), [u64::from(done)]);
        let n = done as f32;
        // 1 + 2 + ... + n, and so much over 4 Hz.
        let sum = n * (n + 1.0) / 2.0;
        assert_eq!(floats(engine, &runner, out), [sum, sum / 4.0, n, time as f32], "frame {frame}");
    }
}

pub fn a_thousand_steps_in_a_frame(engine: &mut Engine) {
    let (plan, out) = stepping();
    let mut runner = prepare(engine, plan);
    step(engine, &mut runner, 250.0, 1000);
    assert_eq!(floats(engine, &runner, out)[..3], [500_500.0, 125_125.0, 1000.0]);
    let report = runner.finish(engine).unwrap();
    assert_eq!(report.passes[0].runs, 1000);
}

pub fn state_goes_on_unless_its_key_changes(engine: &mut Engine) {
    let (plan, out) = stepping();
    let mut runner = prepare(engine, plan.clone());
    step(engine, &mut runner, 0.0, 3);
    let mut runner = engine.prepare(plan.clone(), Some(runner)).unwrap();
    assert!(runner.build_report().state_kept["sim"]);
    step(engine, &mut runner, 0.0, 1);
    assert_eq!(floats(engine, &runner, out)[..3], [10.0, 2.5, 4.0]);

    let mut other = plan;
    other.steps[0].key = 2;
    let mut runner = engine.prepare(other, Some(runner)).unwrap();
    assert!(!runner.build_report().state_kept["sim"]);
    step(engine, &mut runner, 0.0, 1);
    assert_eq!(floats(engine, &runner, out)[..3], [1.0, 0.25, 1.0]);
    runner.reset_state(engine).unwrap();
    step(engine, &mut runner, 0.0, 2);
    assert_eq!(floats(engine, &runner, out)[..3], [3.0, 0.75, 2.0]);
}

pub fn the_host_answers_with_values_of_the_step(engine: &mut Engine) {
    let (plan, out) = stepping();
    let mut runner = prepare(engine, plan);
    let asked = RefCell::new(Vec::new());
    let live = |name: &str, step: Option<&StepInfo>| {
        asked.borrow_mut().push((name.to_owned(), step.map(|s| s.step)));
        (name == "time").then(|| Value::Float(step.map_or(-1.0, |s| s.step as f64)))
    };
    let now = Frame { steps: &[2], live: &live, ..frame() };
    runner.run(engine, &now).unwrap();
    assert_eq!(floats(engine, &runner, out), [3.0, 1.0, 2.0, -1.0]);
    assert!(asked.borrow().contains(&("time".into(), None)));
    assert!(asked.borrow().contains(&("step".into(), Some(1))));
}

pub fn chosen_passes_alone_run(engine: &mut Engine) {
    let (plan, out) = stepping();
    let mut runner = prepare(engine, plan);
    let now = Frame { steps: &[2], only: Some(&[true, false]), ..frame() };
    runner.run(engine, &now).unwrap();
    let report = runner.finish(engine).unwrap();
    assert_eq!(report.passes.iter().map(|p| (p.path.as_str(), p.runs)).collect::<Vec<_>>(), [("sim/step", 2)]);
    assert_eq!(floats(engine, &runner, out), [0.0; 4]);
    step(engine, &mut runner, 0.0, 0);
    assert_eq!(floats(engine, &runner, out)[..3], [3.0, 0.75, 2.0]);
}
