//! Small graphs, one thing at a time.

use meniscus::engine::{Engine, Frame, Policy, Report, Runner, StepInfo};
use meniscus::graph::value::Value;
use meniscus::plan::changes::{Cause, Reason};
use meniscus::plan::model::{InputInfo, ObjectRef, PassKind, Plan, Slot, Texture};
use wgpu::TextureUsages;

use crate::planning::{Test, object, texture};

struct Now {
    time: f64,
    eye: f64,
    steps: u32,
}

const STILL: Now = Now { time: 1.0, eye: 2.0, steps: 0 };

fn prepare(engine: &mut Engine, plan: Plan, before: Option<Runner>) -> Runner {
    engine.prepare(plan, before).unwrap_or_else(|refused| panic!("{:#?}", refused.diagnostics))
}

fn only(engine: &Engine, runner: &mut Runner, now: &Now, only: Option<&[bool]>) -> Report {
    let live = |name: &str, _: Option<&StepInfo>| (name == "camera.position").then(|| Value::vec([now.eye, 0.0, 0.0]));
    let steps = [now.steps];
    let frame = Frame { time: now.time, delta: 0.1, frame: 0, steps: &steps, live: &live, only };
    runner.run(engine, &frame).unwrap_or_else(|d| panic!("{d:#?}"));
    runner.finish(engine).unwrap()
}

fn run(engine: &Engine, runner: &mut Runner, now: &Now) -> Report {
    only(engine, runner, now, None)
}

/// Paths of the passes that ran.
fn ran(report: &Report) -> Vec<&str> {
    report.passes.iter().map(|p| p.path.as_str()).collect()
}

fn float(engine: &Engine, runner: &Runner, name: &str) -> f32 {
    let bytes = runner.read_buffer(engine, runner.plan().names[name]).unwrap();
    f32::from_le_bytes(bytes[..4].try_into().unwrap())
}

fn word(engine: &Engine, runner: &Runner, name: &str) -> u32 {
    float(engine, runner, name).to_bits()
}

/// `seen` is of a parameter and the camera, `clocked` of the time; `x` and `y` share memory.
fn sharing() -> Plan {
    let graph = r#"Graph(
        inputs: { "camera": Camera },
        params: { "gain": Float(default: 5.0, min: 0.0, max: 9.0) },
        resources: { "x": Buffer(items: 64), "eye": Buffer(items: 64), "seen": Buffer(items: 64),
                     "y": Buffer(items: 64), "clocked": Buffer(items: 64) },
        passes: [
            Compute(name: "x", shader: "gain.wgsl", each: Item("x"), bind: {"dst": "x"}),
            Compute(name: "eye", shader: "eye.wgsl", each: Item("eye"), bind: {"dst": "eye"}),
            Compute(name: "seen", shader: "mix.wgsl", each: Item("seen"), bind: {"left": "x", "right": "eye", "dst": "seen"}),
            Compute(name: "y", shader: "clock.wgsl", each: Item("y"), bind: {"dst": "y"}),
            Compute(name: "clocked", shader: "mix.wgsl", each: Item("clocked"), bind: {"left": "y", "right": "y", "dst": "clocked"}),
        ],
        outputs: ["seen", "clocked"],
    )"#;
    let mut plan = Test::new(graph).input("camera", InputInfo::Camera).root("clocked").plan();
    let both = vec![object(&plan, "x"), object(&plan, "y")];
    plan.memory.keep.retain(|slot| !slot.objects.iter().any(|id| both.contains(id)));
    plan.memory.keep.push(Slot { objects: both, bytes: 256 });
    plan
}

/// What `seen` is after the time and then the camera changed, and what ran for the camera.
fn seen_after_both(engine: &mut Engine, plan: Plan) -> (f32, Report) {
    let mut runner = prepare(engine, plan, None);
    let first = run(engine, &mut runner, &STILL);
    assert_eq!(ran(&first), ["x", "eye", "seen", "y", "clocked"]);
    assert!(first.units.iter().all(|u| u.why.contains(&Reason::First)));
    assert!(ran(&run(engine, &mut runner, &STILL)).is_empty());
    let now = Now { time: 7.0, ..STILL };
    assert_eq!(ran(&run(engine, &mut runner, &now)), ["y", "clocked"]);
    let report = run(engine, &mut runner, &Now { eye: 3.0, ..now });
    assert_eq!(float(engine, &runner, "clocked"), 14.0);
    (float(engine, &runner, "seen"), report)
}

pub fn what_reads_overwritten_memory_has_it_written_again(engine: &mut Engine) {
    let (seen, report) = seen_after_both(engine, sharing());
    assert_eq!(seen, 8.0);
    assert_eq!(ran(&report), ["x", "eye", "seen"]);
    let why = |path: &str| &report.units[sharing().passes.iter().find(|p| p.path == path).unwrap().unit].why;
    assert_eq!(*why("x"), [Reason::Shared]);
    assert_eq!(*why("eye"), [Reason::Cause(Cause::Live("camera.position".into()))]);
    assert_eq!(*why("y"), []);
}

pub fn a_way_back_that_was_forgotten_is_seen(engine: &mut Engine) {
    let mut plan = sharing();
    let seen = plan.passes.iter().position(|p| p.path == "seen").unwrap();
    plan.passes[seen].accesses.iter_mut().filter(|a| !a.write).for_each(|a| a.read = false);
    assert_ne!(seen_after_both(engine, plan).0, 8.0, "what was overwritten is not what was written");
}

pub fn steps_alone_make_their_readers_run(engine: &mut Engine) {
    let graph = r#"Graph(
        state: { "s": Buffer(items: 8), "t": Buffer(items: 8) },
        resources: { "out": Buffer(items: 8), "clock": Buffer(items: 8) },
        passes: [
            Steps(rate: 60, passes: [
                Compute(name: "one", shader: "step.wgsl", each: Item("t"), bind: {"src": "s", "dst": "t"}),
                Compute(name: "two", shader: "add.wgsl", each: Item("s"), bind: {"dst": "s"}),
                Compute(name: "three", shader: "clock.wgsl", each: Item("clock"), bind: {"dst": "clock"}),
            ]),
            Compute(name: "show", shader: "copy.wgsl", each: Item("out"), bind: {"src": "t", "dst": "out"}),
        ],
        outputs: ["out"],
    )"#;
    let plan = Test::new(graph).plan();
    let mut runner = prepare(engine, plan.clone(), None);
    assert_eq!(ran(&run(engine, &mut runner, &STILL)), ["show"]);
    let report = run(engine, &mut runner, &Now { steps: 3, ..STILL });
    assert_eq!(ran(&report), ["one", "two", "show"]);
    assert_eq!(word(engine, &runner, "out"), 4);
    // The steps' time is the step's: that of the frame makes nothing run.
    assert!(ran(&run(engine, &mut runner, &Now { time: 9.0, ..STILL })).is_empty());
    let mut runner = prepare(engine, plan, Some(runner));
    assert!(ran(&run(engine, &mut runner, &STILL)).is_empty(), "a plan of the same says nothing new");
    runner.reset_state(engine).unwrap();
    let report = run(engine, &mut runner, &STILL);
    assert_eq!(ran(&report), ["show"]);
    assert!(report.units.iter().any(|u| u.why == [Reason::Reset]));
    assert_eq!(word(engine, &runner, "out"), 0);
}

/// A picture that is handed in, and what is made of it.
fn filtered() -> Plan {
    let graph = r#"Graph(
        inputs: { "picture": Texture },
        resources: { "out": Texture(format: Rgba16Float, size: (8, 8)) },
        passes: [ Fullscreen(name: "look", shader: "filter.wgsl", color: ["out"], bind: {"src": "picture"}) ],
        outputs: ["out"],
    )"#;
    let usages = TextureUsages::TEXTURE_BINDING | TextureUsages::RENDER_ATTACHMENT;
    let picture = Texture { usages, ..texture(wgpu::TextureFormat::Rgba16Float) };
    Test::new(graph).input("picture", InputInfo::Texture(picture)).plan()
}

pub fn others_resources_count_by_their_version(engine: &mut Engine) {
    let mut runner = prepare(engine, filtered(), None);
    let id = object(runner.plan(), "picture");
    let texture = engine.gpu().device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 8, height: 8, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let mut versions = Vec::new();
    for version in [1, 1, 2, 2] {
        runner.share_texture_version(id, &texture, version).unwrap();
        versions.push(run(engine, &mut runner, &STILL).passes.len());
    }
    assert_eq!(versions, [1, 0, 1, 0]);
    runner.share_texture(id, &texture).unwrap();
    let unknown: Vec<usize> = (0..3).map(|_| run(engine, &mut runner, &STILL).passes.len()).collect();
    assert_eq!(unknown, [1, 1, 1], "who does not tell has always changed");
    let mut runner = prepare(engine, filtered(), Some(runner));
    assert_eq!(run(engine, &mut runner, &STILL).passes.len(), 1, "also after a plan");
    runner.share_texture_version(id, &texture, 2).unwrap();
    run(engine, &mut runner, &STILL);
    assert_eq!(run(engine, &mut runner, &STILL).passes.len(), 0);
    runner.mark_changed(id);
    assert_eq!(run(engine, &mut runner, &STILL).passes.len(), 1);
}

pub fn a_runner_that_takes_from_another_runs_when_that_did(engine: &mut Engine) {
    let graph = r#"Graph(
        inputs: { "camera": Camera },
        resources: { "made": Texture(format: Rgba16Float, size: (8, 8)), "more": Like("made"), "eye": Buffer(items: 64) },
        passes: [
            Compute(name: "eye", shader: "eye.wgsl", each: Item("eye"), bind: {"dst": "eye"}),
            Fullscreen(name: "made", shader: "paint.wgsl", color: ["made"]),
            Fullscreen(name: "more", shader: "filter.wgsl", color: ["more"], bind: {"src": "made"}),
        ],
        outputs: ["made", "eye"],
    )"#;
    let mut first =
        prepare(engine, Test::new(graph).input("camera", InputInfo::Camera).root("eye").root("more").plan(), None);
    let mut second = prepare(engine, filtered(), None);
    let (made, picture) = (ObjectRef::Fixed(object(first.plan(), "made")), object(second.plan(), "picture"));
    let mut both = |first: &mut Runner, now: &Now| {
        let mut ran = vec![run(engine, first, now).passes.len()];
        second.share(picture, first, made).unwrap();
        ran.push(run(engine, &mut second, now).passes.len());
        ran
    };
    assert_eq!(both(&mut first, &STILL), [3, 1]);
    assert_eq!(both(&mut first, &STILL), [0, 0]);
    assert_eq!(both(&mut first, &Now { eye: 5.0, ..STILL }), [1, 0], "what was taken did not change");
    first.run_all(true);
    assert_eq!(both(&mut first, &Now { eye: 5.0, ..STILL }), [3, 1]);
}

pub fn what_was_left_out_runs_later(engine: &mut Engine) {
    let mut runner = prepare(engine, sharing(), None);
    run(engine, &mut runner, &STILL);
    let now = Now { eye: 4.0, ..STILL };
    let report = only(engine, &mut runner, &now, Some(&[true, false, true, true, true]));
    assert_eq!(ran(&report), ["x", "seen"], "of those that were chosen");
    let report = run(engine, &mut runner, &now);
    assert_eq!(ran(&report), ["x", "eye", "seen"]);
    assert!(report.units.iter().any(|u| u.why.contains(&Reason::Unfinished)));
    assert_eq!(float(engine, &runner, "seen"), 9.0);
}

pub fn everything_runs_if_asked_for(engine: &mut Engine) {
    let mut runner = prepare(engine, sharing(), None);
    run(engine, &mut runner, &STILL);
    runner.run_all(true);
    let report = run(engine, &mut runner, &STILL);
    assert_eq!(report.passes.len(), 5);
    assert!(report.units.iter().all(|u| u.why == [Reason::Asked]));
    let mut runner = prepare(engine, sharing(), Some(runner));
    assert_eq!(run(engine, &mut runner, &STILL).passes.len(), 5, "also after a plan");
    runner.run_all(false);
    let mut smallest = sharing();
    smallest.memory.policy = Policy::Smallest;
    let mut runner = prepare(engine, smallest, Some(runner));
    run(engine, &mut runner, &STILL);
    assert!(ran(&run(engine, &mut runner, &STILL)).is_empty());
    let report = run(engine, &mut runner, &Now { time: 4.0, ..STILL });
    assert_eq!(report.passes.len(), 5, "on the least memory all run if one does");
    assert!(report.units.iter().any(|u| u.why == [Reason::Together]));
}

pub fn counts_of_what_was_skipped_stay(engine: &mut Engine) {
    let graph = r#"Graph(
        inputs: { "camera": Camera },
        resources: { "list": Counted(capacity: 1000), "a": Buffer(items: 64), "eye": Buffer(items: 64) },
        passes: [
            Clear(of: "list"), Clear(of: "a"),
            Compute(name: "append", shader: "append.wgsl", each: Threads(128, 1, 1)),
            Compute(name: "use", shader: "consume.wgsl", each: Item("list"), bind: {"dst": "a"}),
            Compute(name: "eye", shader: "eye.wgsl", each: Item("eye"), bind: {"dst": "eye"}),
        ],
        outputs: ["a", "eye"],
    )"#;
    let plan = || Test::new(graph).input("camera", InputInfo::Camera).root("eye").plan();
    let mut runner = prepare(engine, plan(), None);
    let counts = |report: &Report| report.counts.iter().map(|c| (c.path.clone(), c.raw)).collect::<Vec<_>>();
    let all = [("list".to_owned(), 128)];
    assert_eq!(counts(&run(engine, &mut runner, &STILL)), all);
    assert_eq!(counts(&run(engine, &mut runner, &STILL)), all, "nothing ran");
    let report = run(engine, &mut runner, &Now { eye: 6.0, ..STILL });
    assert_eq!((ran(&report), counts(&report)), (vec!["eye"], all.to_vec()), "others ran");
    let mut runner = prepare(engine, plan(), Some(runner));
    let report = run(engine, &mut runner, &Now { eye: 7.0, ..STILL });
    assert_eq!((ran(&report), counts(&report)), (vec!["eye"], all.to_vec()), "after a plan");
}

/// One who uses a count always, and another in a branch. More is appended than fits.
fn branching(others: bool) -> Plan {
    let graph = r#"Graph(
        params: { "others": Bool(default: false) },
        resources: { "list": Counted(capacity: 100), "a": Buffer(items: 128), "b": Buffer(items: 128) },
        passes: [
            Clear(of: "list"), Clear(of: "a"),
            Compute(name: "append", shader: "append.wgsl", each: Threads(128, 1, 1)),
            Compute(name: "use", shader: "consume.wgsl", each: Item("list"), bind: {"dst": "a"}),
            If(test: "others", then: [
                Clear(of: "b"),
                Compute(name: "more", shader: "consume.wgsl", each: Item("list"), bind: {"dst": "b"}),
            ]),
        ],
        outputs: ["a"],
    )"#;
    let test = Test::new(graph).param("others", Value::Bool(others));
    if others { test.root("b").plan() } else { test.plan() }
}

/// What ran for a branch that was taken after a frame without it, and what its pass made of the list.
fn branch(engine: &mut Engine, taken: Plan) -> (Report, Vec<u32>) {
    let mut runner = prepare(engine, branching(false), None);
    run(engine, &mut runner, &STILL);
    // More than one plan may come between two frames.
    for plan in [branching(true), branching(false), branching(true), taken] {
        runner = prepare(engine, plan, Some(runner));
    }
    let report = run(engine, &mut runner, &STILL);
    let bytes = runner.read_buffer(engine, runner.plan().names["b"]).unwrap();
    (report, bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect())
}

pub fn a_branch_with_a_count_settles_nothing_anew(engine: &mut Engine) {
    let (report, mut list) = branch(engine, branching(true));
    let more = ran(&report);
    assert!(more.len() == 2 && more.contains(&"more"), "the branch alone: {more:?}");
    let counts: Vec<_> = report.counts.iter().map(|count| (count.path.as_str(), count.raw)).collect();
    assert_eq!(counts, [("list", 128)], "how many were appended is known still");
    let rest = list.split_off(100);
    assert!(rest.iter().all(|word| *word == 0), "as many as fit");
    list.sort_unstable();
    list.dedup();
    assert_eq!(list.len(), 100, "each is there");

    let mut runner = prepare(engine, branching(true), None);
    run(engine, &mut runner, &STILL);
    let mut runner = prepare(engine, branching(false), Some(runner));
    assert!(ran(&run(engine, &mut runner, &STILL)).is_empty(), "a branch that is left");
}

pub fn a_draw_of_another_count_runs(engine: &mut Engine) {
    let plan = |vertices: u32, drawn: &str| {
        let of = |list: &str, threads: u32, out: &str| {
            format!(
                r#"Clear(of: "{list}"), Clear(of: "{out}"),
                Compute(name: "{list}", shader: "append.wgsl", each: Threads({threads}, 1, 1), bind: {{"list": "{list}"}}),
                Compute(name: "{out}", shader: "consume.wgsl", each: Item("{list}"), bind: {{"list": "{list}", "dst": "{out}"}}),"#
            )
        };
        let passes = format!(
            r#"{}{} Draw(name: "draw", shader: "triangle.wgsl", vertices: {vertices}, instances: Each("{drawn}"),
                color: [(to: "o", clear: 0.0)])"#,
            of("few", 64, "a"),
            of("many", 128, "b"),
        );
        let resources = r#""few": Counted(capacity: 200), "many": Counted(capacity: 200), "a": Buffer(items: 200),
            "b": Buffer(items: 200), "o": Texture(format: R32Float, size: (4, 4))"#;
        let looked_at = ["b", "o", "few", "many"];
        looked_at.iter().fold(Test::of(resources, &passes, r#""a", "b", "o""#), |test, name| test.root(name)).plan()
    };
    let mut runner = prepare(engine, plan(3, "few"), None);
    run(engine, &mut runner, &STILL);
    // The count that is drawn, and how much for each, is nowhere but in the arguments.
    for (vertices, drawn, more) in [(3, "few", &[][..]), (6, "few", &["draw"]), (6, "many", &["draw"])] {
        runner = prepare(engine, plan(vertices, drawn), Some(runner));
        let report = run(engine, &mut runner, &STILL);
        assert_eq!(ran(&report), more, "{vertices} vertices for each of `{drawn}`");
    }
}

pub fn arguments_that_nobody_gave_are_seen(engine: &mut Engine) {
    let mut plan = branching(true);
    let slot = plan.passes.iter().find(|pass| pass.path == "more").unwrap().kind.slot().unwrap();
    for pass in &mut plan.passes {
        if let PassKind::Settle { arguments, .. } = &mut pass.kind {
            arguments.retain(|argument| argument.slot != slot);
        }
    }
    // The plans before it are sound, and so would be the arguments that go over.
    let mut runner = prepare(engine, branching(false), None);
    run(engine, &mut runner, &STILL);
    let mut runner = prepare(engine, plan, Some(runner));
    run(engine, &mut runner, &STILL);
    assert_eq!(word(engine, &runner, "b"), 0, "nothing was dispatched");
}
