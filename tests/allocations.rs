//! A frame in which nothing new comes up allocates nothing of ours: counted allocation by allocation,
//! each with the calls that led there. What wgpu allocates is its own.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "engine/harness.rs"]
mod harness;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use glam::DVec3;
use meniscus::diagnostic::{Sources, Span};
use meniscus::engine::{Engine, Frame, Gpu, GpuOptions, Screen, StepInfo};
use meniscus::files::DiskFiles;
use meniscus::graph::value::Value;
use meniscus::host::{Cache, Job, Live, Session, load};
use meniscus::plan::instantiate_stand_in;
use meniscus::plan::model::{Geometry, Pass, PassKind};
use meniscus::scene::Camera;
use meniscus::{check, program};

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

fn main() -> ExitCode {
    harness::run(cases![
        orbiting_allocates_nothing,
        steps_allocate_nothing,
        frames_for_others_allocate_nothing,
        frames_of_a_window_allocate_nothing,
        panes_of_glass_allocate_nothing,
        expressions_of_live_names_allocate_nothing,
        what_allocates_is_caught,
    ])
}

/// Frames that make what is made once, and frames that count.
const WARM: usize = 8;
const COUNTED: usize = 12;

/// How many allocations come from each place of ours, in all of `what`.
fn ours(what: impl FnOnce()) -> BTreeMap<String, u64> {
    let file = std::env::temp_dir().join(format!("meniscus-allocations-{}.json", std::process::id()));
    let profiler = dhat::Profiler::builder().file_name(&file).trim_backtraces(None).build();
    what();
    drop(profiler);
    let profile: serde_json::Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    _ = std::fs::remove_file(&file);
    let frames: Vec<&str> = profile["ftbl"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    let (files, mut places) = (our_files(), BTreeMap::new());
    for point in profile["pps"].as_array().unwrap() {
        // From the innermost call outwards: whose is the first that is somebody's?
        let calls: Vec<&str> =
            point["fs"].as_array().unwrap().iter().map(|at| frames[at.as_u64().unwrap() as usize]).collect();
        let somebody = calls.iter().enumerate().find_map(|(depth, call)| Some((owner(call, &files)?, depth)));
        if let Some((Owner::Us, depth)) = somebody {
            *places.entry(calls[..=depth].join("\n  <- ")).or_default() += point["tbk"].as_u64().unwrap();
        }
    }
    places
}

enum Owner {
    Us,
    Wgpu,
}

/// Whose a call is, such as `0x1f: name (src/engine/run.rs:296:21)`; the standard library and small crates
/// work for their callers. What was inlined has no crate in its name, but a file, of which the profile has
/// the last three parts.
fn owner(call: &str, files: &[String]) -> Option<Owner> {
    let (_, call) = call.split_once(": ")?;
    let (name, place) = call.rsplit_once(" (")?;
    // Made by the attribute on the allocator: `__rustc::__rust_alloc`, without its crate where it was inlined.
    if name.starts_with("__rust") {
        return None;
    }
    let file = place.split(':').next()?;
    let name = name.trim_start_matches(['<', '&', '*', '(', '[']).trim_start_matches("mut ").trim_start_matches("dyn ");
    let of = |crates: &[&str]| crates.iter().any(|c| name.strip_prefix(c).is_some_and(|rest| rest.starts_with("::")));
    let wgpus = ["wgpu", "wgpu_core", "wgpu_hal", "wgpu_types", "wgpu_naga_bridge", "naga", "pollster"];
    if files.iter().any(|ours| ours == file) || of(&["meniscus", "allocations"]) {
        Some(Owner::Us)
    } else if of(&wgpus) || file.starts_with("src/api/") || file.starts_with("src/backend/") {
        Some(Owner::Wgpu)
    } else {
        None
    }
}

/// The last three parts of the paths of all our files.
fn our_files() -> Vec<String> {
    fn visit(folder: &Path, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                visit(&path, found);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let parts: Vec<_> = path.iter().map(|part| part.to_str().unwrap()).collect();
                found.push(parts[parts.len().saturating_sub(3)..].join("/"));
            }
        }
    }
    let (root, mut found) = (Path::new(env!("CARGO_MANIFEST_DIR")), Vec::new());
    ["src", "tests"].iter().for_each(|folder| visit(&root.join(folder), &mut found));
    found
}

fn nothing_of_ours(name: &str, what: impl FnOnce()) {
    let places = ours(what);
    assert!(places.is_empty(), "{name}: in {COUNTED} frames there were allocations of ours: {places:#?}");
}

/// A value for each name: what moves with the frame is read from a camera.
fn value(name: &str, camera: &Camera) -> Option<Value> {
    let (input, field) = name.split_once('.')?;
    let light = meniscus::scene::Light { direction: DVec3::NEG_Y, color: DVec3::ONE, intensity: 2.0 };
    match (input, field) {
        ("camera", _) => camera.field(field, [40, 30]),
        (_, "origin") => Some(Value::vec([0.0; 3])),
        (_, "pressed") => Some(Value::Int(0)),
        _ => light.field(field),
    }
}

fn camera(nth: usize) -> Camera {
    let angle = nth as f64 * 0.01;
    Camera::new(DVec3::new(2.0 * angle.cos(), 1.0, 2.0 * angle.sin()), DVec3::ZERO, 45.0)
}

/// Frames of a shipped graph with a stand-in for its inputs; `of` says what each frame has.
fn frames(engine: &mut Engine, graph: &str, steps: u32, count: impl FnOnce(&mut dyn FnMut(usize))) {
    let mut sources = Sources::new();
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("graphs").join(graph);
    let program = program::load(&DiskFiles, &mut sources, path.to_str().unwrap(), None).program.unwrap();
    let mut request = check::stand_in(&program);
    (request.features, request.limits) = (engine.gpu().features(), engine.gpu().limits());
    request.viewport = [40, 30];
    let plan = instantiate_stand_in(&program, &request).unwrap();
    let due = vec![steps; plan.steps.len()];
    let mut runner = engine.prepare(plan, None).unwrap_or_else(|refused| panic!("{:?}", refused.diagnostics));
    let mut frame = |nth: usize| {
        let camera = camera(nth);
        let live = |name: &str, _: Option<&StepInfo>| value(name, &camera);
        let time = nth as f64 / 60.0;
        let now = Frame { time, delta: 1.0 / 60.0, frame: nth as u64, steps: &due, live: &live, only: None };
        runner.advance(engine, &now).unwrap();
    };
    (0..WARM).for_each(&mut frame);
    count(&mut frame);
}

fn shipped() -> Vec<String> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("graphs");
    let names = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".ron")).collect();
    names.sort();
    names
}

fn orbiting_allocates_nothing(engine: &mut Engine) {
    for graph in shipped() {
        frames(engine, &graph, 0, |frame| {
            nothing_of_ours(&graph, || (WARM..WARM + COUNTED).for_each(frame));
        });
    }
}

/// Into an embedder's commands, who submits them.
fn frames_for_others_allocate_nothing(engine: &mut Engine) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("graphs/imai2014.ron");
    let program = program::load(&DiskFiles, &mut Sources::new(), path.to_str().unwrap(), None).program.unwrap();
    let mut request = check::stand_in(&program);
    (request.features, request.limits) = (engine.gpu().features(), engine.gpu().limits());
    request.viewport = [40, 30];
    let plan = instantiate_stand_in(&program, &request).unwrap();
    let mut runner = engine.prepare(plan, None).unwrap_or_else(|refused| panic!("{:?}", refused.diagnostics));
    let mut frame = |nth: usize| {
        let camera = camera(nth);
        let live = |name: &str, _: Option<&StepInfo>| value(name, &camera);
        let now = Frame { time: 0.0, delta: 1.0 / 60.0, frame: nth as u64, steps: &[], live: &live, only: None };
        let mut theirs = engine.gpu().device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        runner.encode(engine, &now, &mut theirs).unwrap();
        engine.gpu().queue().submit([theirs.finish()]);
    };
    (0..WARM).for_each(&mut frame);
    nothing_of_ours("encode", || (WARM..WARM + COUNTED).for_each(&mut frame));
}

fn steps_allocate_nothing(engine: &mut Engine) {
    frames(engine, "ripples.ron", 2, |frame| {
        nothing_of_ours("ripples.ron with steps", || (WARM..WARM + COUNTED).for_each(frame));
    });
}

/// A scene as a window draws it: pointers, lights and bodies that move, and the presenting graph.
fn frames_of_a_window_allocate_nothing(_: &mut Engine) {
    for scene in ["crown_floating.ron", "dam_break_2014.ron", "pool_drop.ron", "ripples.ron"] {
        let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
        window(scene, source, |_| ());
    }
}

/// Panes of glass, which each camera sees in another order.
fn panes_of_glass_allocate_nothing(_: &mut Engine) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("panes");
    std::fs::create_dir_all(&folder).unwrap();
    let pane = "mtllib pane.mtl\nusemtl glass\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.join("pane.obj"), pane).unwrap();
    std::fs::write(folder.join("pane.mtl"), "newmtl glass\nKd 0.5 0.6 0.7\nd 0.4\n").unwrap();
    let panes: Vec<String> = (0..40).map(|i| format!("(position: ({}, 0, {}))", i % 7, i % 11)).collect();
    let scene = format!(
        "Scene(graph: \"imai2016.ron\", lights: {{\"sun\": Light(direction: (0, -1, 0))}},
            meshes: {{\"meshes\": [(file: \"pane.obj\", instances: [{}])]}})",
        panes.join(", ")
    );
    let source = folder.join("panes.ron");
    std::fs::write(&source, scene).unwrap();
    window("panes.ron", source, |session| {
        let blended = |pass: &Pass| match &pass.kind {
            PassKind::Draw(draw) => match &draw.geometry {
                Geometry::Meshes(meshes) => meshes.draws.iter().filter(|call| call.blended).count(),
                _ => 0,
            },
            _ => 0,
        };
        let most = session.plan().unwrap().passes.iter().map(blended).max();
        assert_eq!(most, Some(40), "each pane is drawn by itself");
    });
}

/// Frames of a scene as a window draws them, after some that warm up.
fn window(scene: &str, source: PathBuf, look: impl FnOnce(&Session)) {
    let job = Job { source, size: Some([40, 30]), ..Job::default() };
    let content = load(&DiskFiles, &mut Sources::new(), &job, &mut Cache::default()).content.unwrap();
    let gpu = Gpu::open(&GpuOptions::default()).unwrap();
    let (mut session, mut screen) = (Session::new(gpu.clone()), Screen::new(&gpu).unwrap());
    session.build(content).unwrap();
    look(&session);
    let mut frame = |nth: usize| {
        let time_s = nth as f64 / 60.0;
        let camera = Camera { up: DVec3::Y, ..camera(nth) };
        let live = Live { camera, time_s, delta_s: 1.0 / 60.0, frame: nth as u64, steps: &[1], only: None };
        session.advance(&live).unwrap();
        session.show(&live, &mut screen).unwrap();
    };
    (0..WARM).for_each(&mut frame);
    nothing_of_ours(scene, || (WARM..WARM + COUNTED).for_each(&mut frame));
}

fn expressions_of_live_names_allocate_nothing(_: &mut Engine) {
    use meniscus::graph::eval::eval_live;
    let parsed = |text: &str| {
        let mut sources = Sources::new();
        let file = sources.add("test", text);
        meniscus::graph::expr::parse(text, Span { file, start: 0, end: text.len() as u32 }, true).unwrap()
    };
    let camera = camera(0);
    let all = ["camera.position * 2.0 + 1", "(camera.position.x, time)", "min(time, 3) * floor(camera.tan_half_fov.y)"];
    for text in all {
        let expr = parsed(text);
        let known = |name: &str| if name == "time" { Some(Value::Float(0.5)) } else { value(name, &camera) };
        assert!(eval_live(&expr, &known).is_some(), "{text}");
        nothing_of_ours(text, || assert!(eval_live(&expr, &known).is_some()));
    }
}

/// What the other tests would say of frames that allocate, in the engine and in who answers it.
fn what_allocates_is_caught(engine: &mut Engine) {
    let (plan, mut request) = {
        let mut sources = Sources::new();
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("graphs/ripples.ron");
        let program = program::load(&DiskFiles, &mut sources, path.to_str().unwrap(), None).program.unwrap();
        let request = check::stand_in(&program);
        (program, request)
    };
    (request.features, request.limits) = (engine.gpu().features(), engine.gpu().limits());
    let plan = instantiate_stand_in(&plan, &request).unwrap();
    let mut runner = engine.prepare(plan, None).unwrap_or_else(|refused| panic!("{:?}", refused.diagnostics));
    let mut run = |asks: bool, reports: bool, nth: usize| {
        let camera = camera(nth);
        let live = |name: &str, _: Option<&StepInfo>| {
            let said = asks.then(|| name.to_owned());
            value(said.as_deref().unwrap_or(name), &camera)
        };
        let now = Frame { time: 0.0, delta: 0.1, frame: 0, steps: &[1], live: &live, only: None };
        match reports {
            true => _ = runner.run(engine, &now).unwrap(),
            false => runner.advance(engine, &now).unwrap(),
        }
    };
    (0..WARM).for_each(|nth| run(false, false, nth));
    assert!(ours(|| run(false, false, WARM)).is_empty());
    let asked = ours(|| run(true, false, WARM + 1));
    assert!(asked.keys().any(|place| place.contains("tests/allocations.rs")), "{asked:#?}");
    let reported = ours(|| run(false, true, WARM + 2));
    assert!(reported.keys().any(|place| place.contains("engine/timing.rs")), "{reported:#?}");
}
