//! What nobody should do, and some do: a thousand changes between two frames, pictures of one pixel
//! and of more than there is room for. All of it with the picture kept and nothing leaked.

use std::path::Path;

use meniscus::check;
use meniscus::diagnostic::Sources;
use meniscus::engine::{Engine, Frame, Gpu, Runner, StepInfo, wanted_features};
use meniscus::files::{DiskFiles, Files, MemoryFiles};
use meniscus::graph::value::Value;
use meniscus::plan::model::{InputInfo, Plan, Request};
use meniscus::plan::{instantiate, instantiate_stand_in};
use meniscus::program::{self, Program};
use meniscus::scene::{Camera, Light};

use crate::support::{frame, prepare, words};

const GRAPH: &str = r#"Graph(
    params: { "gain": Int(default: 0, min: 0, max: 9999), "depth": Int(default: 1, min: 1, max: 8) },
    resources: { "kept": Buffer(items: 4), "out": Buffer(items: "4 * depth") },
    passes: [
        Compute(name: "keep", shader: "keep.wgsl", each: Item("kept")),
        Compute(name: "gain", shader: "gain.wgsl", each: Item("out")),
    ],
    outputs: ["out"],
)"#;
const KEEP: &str = "var<storage, read_write> kept: array<u32>;
@compute @workgroup_size(4) fn main(@builtin(global_invocation_id) i: vec3u) { kept[i.x] = 7u; }";
const GAIN: &str = "struct Values { gain: u32 } var<uniform> values: Values;
var<storage, read> kept: array<u32>;
var<storage, read_write> out: array<u32>;
@compute @workgroup_size(4) fn main(@builtin(global_invocation_id) i: vec3u) {
    if i.x < arrayLength(&out) { out[i.x] = kept[i.x % 4u] + values.gain; }
}";

fn load(files: &dyn Files, path: &str) -> Program {
    let loaded = program::load(files, &mut Sources::new(), path, None);
    loaded.program.unwrap_or_else(|| panic!("{path}: {:?}", loaded.diagnostics))
}

fn shipped() -> Vec<(String, Program)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("graphs");
    let names = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".ron")).collect();
    names.sort();
    names.into_iter().map(|name| (name.clone(), load(&DiskFiles, folder.join(name).to_str().unwrap()))).collect()
}

/// A slider that is dragged makes many plans for one frame: the last one counts, what does not read the
/// parameter is kept, and all that the others made is gone.
pub fn a_parameter_changed_a_thousand_times_in_a_frame(engine: &mut Engine) {
    let files = MemoryFiles::default()
        .with("graphs/g.ron", GRAPH)
        .with("shaders/keep.wgsl", KEEP)
        .with("shaders/gain.wgsl", GAIN);
    let program = load(&files, "graphs/g.ron");
    let plan = |engine: &Engine, gain: i64, depth: i64| -> Plan {
        let mut request = Request::new([8, 8], engine.gpu().features(), engine.gpu().limits());
        request.params = [("gain", gain), ("depth", depth)].map(|(name, n)| (name.to_owned(), Value::Int(n))).into();
        instantiate(&program, &request).unwrap_or_else(|d| panic!("{d:?}"))
    };
    let first = plan(engine, 0, 1);
    let mut runner = prepare(engine, first);
    let settle = |engine: &Engine, runner: &mut Runner| {
        let report = runner.run(engine, &frame()).unwrap_or_else(|d| panic!("{d:?}"));
        runner.finish(engine).unwrap();
        engine.gpu().poll();
        (report.passes.iter().map(|pass| pass.path.clone()).collect::<Vec<_>>(), engine.gpu().census().unwrap())
    };
    settle(engine, &mut runner);
    runner = engine.prepare(plan(engine, 1, 1), Some(runner)).unwrap_or_else(|r| panic!("{:?}", r.diagnostics));
    let (_, before) = settle(engine, &mut runner);
    for nth in 1..=1000 {
        // Also one that sizes follow from, so that memory comes and goes.
        let next = plan(engine, nth, 1 + nth % 8);
        runner = engine.prepare(next, Some(runner)).unwrap_or_else(|r| panic!("{:?}", r.diagnostics));
    }
    let (ran, after) = settle(engine, &mut runner);
    assert_eq!(ran, ["gain"], "what the parameter does not reach was kept");
    let out = runner.plan().outputs[0].object;
    let meniscus::plan::model::ObjectRef::Fixed(out) = out else { panic!("no state here") };
    assert_eq!(words(engine, &runner, out), [1007; 4]);
    // Modules are let go of once their pipelines are there.
    assert!(after.total() <= before.total(), "what lives on the device: {after:?}, and before {before:?}");
}

/// An answer for every live name of the shipped graphs.
fn live(name: &str, _: Option<&StepInfo>) -> Option<Value> {
    let camera = Camera::new(glam::DVec3::new(1.2, 1.0, 1.2), glam::DVec3::ZERO, 45.0);
    let sun = Light { direction: glam::DVec3::NEG_Y, color: glam::DVec3::ONE, intensity: 2.0 };
    let (input, field) = name.split_once('.')?;
    match (input, field) {
        ("camera", _) => camera.field(field, [8, 8]),
        (_, "origin") => Some(Value::vec([0.0; 3])),
        (_, "pressed") => Some(Value::Int(0)),
        _ => sun.field(field),
    }
}

fn draw(engine: &Engine, runner: &mut Runner) -> Result<(), meniscus::diagnostic::Diagnostics> {
    let steps = vec![1; runner.plan().steps.len()];
    let now = Frame { time: 0.5, delta: 0.1, frame: 0, steps: &steps, live: &live, only: None };
    runner.run(engine, &now)?;
    runner.finish(engine).map(|_| ()).map_err(Into::into)
}

fn request(program: &Program, engine: &Engine, size: [u32; 2]) -> Request {
    let mut request = check::stand_in(program);
    (request.features, request.limits) = (engine.gpu().features(), engine.gpu().limits());
    request.viewport = size;
    // Some hundreds of particles say as much here as a hundred thousand.
    for info in request.inputs.values_mut() {
        if let InputInfo::Particles { count, .. } = info {
            *count = (*count).min(500);
        }
    }
    request
}

/// Every shipped graph goes from a usual size to one pixel, to the widest row, and back, on a real device.
pub fn shipped_graphs_draw_one_pixel(engine: &mut Engine) {
    let most = engine.gpu().limits().max_texture_dimension_2d;
    for (name, program) in shipped() {
        let mut runner = None;
        for size in [[24, 16], [1, 1], [most, 1], [24, 16]] {
            let plan = instantiate_stand_in(&program, &request(&program, engine, size));
            let plan = plan.unwrap_or_else(|d| panic!("{name} at {size:?}: {d:?}"));
            let made = engine.prepare(plan, runner.take());
            let mut made = made.unwrap_or_else(|r| panic!("{name} at {size:?}: {:?}", r.diagnostics));
            draw(engine, &mut made).unwrap_or_else(|d| panic!("{name} at {size:?}: {d:?}"));
            runner = Some(made);
        }
    }
}

/// Of as many pixels as the device has and one more, each shipped graph is made ready or refused with
/// words, and what was ready before still is. The device validates all and stores no texture; it draws
/// nothing either, since wgpu panics where it validates indirect draws on it.
pub fn shipped_graphs_at_the_largest_size(_: &mut Engine) {
    let limits = wgpu::Limits::default();
    let descriptor =
        wgpu::DeviceDescriptor { required_limits: limits, required_features: wanted_features(), ..Default::default() };
    let (device, queue) = wgpu::Device::noop(&descriptor);
    let most = device.limits().max_texture_dimension_2d;
    let mut engine = Engine::new(Gpu::from_parts(None, device, queue));
    let (mut made_ready, mut refused) = (0, 0);
    for (name, program) in shipped() {
        let first = instantiate_stand_in(&program, &request(&program, &engine, [24, 16]));
        let mut runner = prepare(&mut engine, first.unwrap_or_else(|d| panic!("{name}: {d:?}")));
        for size in [[most, most], [most, 1], [most + 1, 1], [u32::MAX, u32::MAX]] {
            let planned = instantiate_stand_in(&program, &request(&program, &engine, size));
            let made = match planned {
                Ok(plan) => engine.prepare(plan, Some(runner)).map_err(|refused| *refused),
                Err(diagnostics) => Err(meniscus::engine::Refused { diagnostics, previous: Some(runner) }),
            };
            made_ready += usize::from(made.is_ok());
            runner = made.unwrap_or_else(|told| {
                refused += 1;
                assert!(told.diagnostics.has_errors(), "{name} at {size:?}");
                assert!(size != [most, 1], "{name} at {size:?}: {:?}", told.diagnostics);
                told.previous.expect("the runner before")
            });
        }
        let again = instantiate_stand_in(&program, &request(&program, &engine, [24, 16]));
        let again = engine.prepare(again.unwrap_or_else(|d| panic!("{name}: {d:?}")), Some(runner));
        assert!(again.is_ok(), "{name}: {again:?}");
    }
    assert!(made_ready >= 4 && refused >= 8, "{made_ready} made ready, {refused} refused");
}
