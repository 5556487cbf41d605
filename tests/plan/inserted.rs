//! What the planner puts in: settled counts, mips, arguments.

use std::collections::BTreeSet;

use meniscus::format::TextureFormat;
use meniscus::plan::model::{Argument, ArgumentKind, InputInfo, ObjectKind, PassKind, Plan};

use crate::planning::{Test, pass, paths, texture};

const LIST: &str = r#""list": Counted(capacity: 50), "a": Buffer(items: 64), "b": Buffer(items: 64), "o": Texture(format: Rgba16Float, size: (8, 8))"#;

const CLEAR: &str = r#"Clear(name: "empty", of: "list"),"#;
const APPEND: &str = r#"Compute(name: "append", shader: "append.wgsl", each: Threads(100, 1, 1)),"#;

fn consume(name: &str, dst: &str) -> String {
    format!(r#"Compute(name: "{name}", shader: "consume.wgsl", each: Item("list"), bind: {{"dst": "{dst}"}}),"#)
}

/// The arguments that the settling pass at `at` writes.
fn arguments(plan: &Plan, at: usize) -> &[Argument] {
    match &plan.passes[at].kind {
        PassKind::Settle { arguments, .. } => arguments,
        other => panic!("{other:?} does not settle"),
    }
}

/// The slot that a pass takes its arguments from.
fn slot(plan: &Plan, at: usize) -> u32 {
    plan.passes[at].kind.slot().unwrap_or_else(|| panic!("{} is not indirect", plan.passes[at].path))
}

/// Every slot is written by one pass at least before the one pass that reads it.
fn slots_are_fed(plan: &Plan) {
    let (mut written, mut read) = (BTreeSet::new(), BTreeSet::new());
    for pass in &plan.passes {
        match &pass.kind {
            PassKind::Settle { arguments, .. } => written.extend(arguments.iter().map(|a| a.slot)),
            PassKind::Arguments { slot, .. } => _ = written.insert(*slot),
            kind => kind.slot().into_iter().for_each(|slot| assert!(read.insert(slot))),
        }
        assert!(read.is_subset(&written), "{} reads a slot that nothing wrote", pass.path);
    }
    assert_eq!(plan.argument_slots as usize, read.len());
    assert!(read.iter().all(|slot| *slot < plan.argument_slots));
}

#[test]
fn counts_are_settled_once_between_appends_and_readers() {
    let passes = [CLEAR, APPEND, &consume("one", "a"), &consume("two", "b")].concat();
    let plan = Test::of(LIST, &passes, r#""a""#).root("b").plan();
    assert_eq!(paths(&plan), ["empty", "append", "list (settle)", "one", "two"]);
    let kind = ArgumentKind::Dispatch { threads: 64 };
    let settle = pass(&plan, "list (settle)");
    assert_eq!(arguments(&plan, settle), [Argument { slot: 0, kind: kind.clone() }, Argument { slot: 1, kind }]);
    assert_eq!((slot(&plan, pass(&plan, "one")), slot(&plan, pass(&plan, "two"))), (0, 1));
    slots_are_fed(&plan);
}

#[test]
fn an_append_after_a_reader_is_settled_again() {
    let more = APPEND.replace("\"append\"", "\"more\"");
    let passes = [CLEAR, APPEND, &consume("one", "a"), &more, &consume("two", "b")].concat();
    let plan = Test::of(LIST, &passes, r#""a""#).root("b").plan();
    let settles: Vec<usize> = (0..plan.passes.len()).filter(|p| plan.passes[*p].path == "list (settle)").collect();
    assert_eq!(settles.len(), 2);
    assert_eq!(arguments(&plan, settles[0]).iter().map(|a| a.slot).collect::<Vec<_>>(), [0]);
    assert_eq!(arguments(&plan, settles[1]).iter().map(|a| a.slot).collect::<Vec<_>>(), [1]);
    assert!(settles[1] > pass(&plan, "more") && settles[1] < pass(&plan, "two"));
    slots_are_fed(&plan);
}

#[test]
fn a_clear_without_an_append_is_settled_too() {
    let plan = Test::of(LIST, &[CLEAR, &consume("one", "a")].concat(), r#""a""#).plan();
    assert_eq!(paths(&plan), ["empty", "list (settle)", "one"]);
    slots_are_fed(&plan);
}

#[test]
fn instances_from_a_count() {
    let draw = r#"Draw(name: "points", shader: "points.wgsl", vertices: 1, topology: PointList, instances: Each("list"), color: [(to: "o", clear: 0.0)]),"#;
    let plan = Test::of(LIST, &[CLEAR, APPEND, draw].concat(), r#""o""#).plan();
    assert_eq!(paths(&plan), ["empty", "append", "list (settle)", "points"]);
    let kind = ArgumentKind::Draw { vertices: Some(1), instances: None, indexed: false };
    assert_eq!(arguments(&plan, 2), [Argument { slot: 0, kind }]);
    slots_are_fed(&plan);
}

/// A list in a step: read, emptied, appended to. Read outside before and behind.
fn around_steps(before: &str, inside: &str, behind: &str) -> Plan {
    let graph = format!(
        r#"Graph(
        state: {{ "list": Counted(capacity: 50) }},
        resources: {{ "a": Buffer(items: 64), "b": Buffer(items: 64), "c": Buffer(items: 64) }},
        passes: [
            {before}
            Steps(rate: 60, passes: [ {inside} ]),
            {behind}
        ],
        outputs: ["c"],
    )"#
    );
    let test = Test::new(&graph).root("b");
    if before.is_empty() { test.plan() } else { test.root("a").plan() }
}

#[test]
fn a_reader_in_a_step_sees_what_the_step_before_appended() {
    let inside = [&consume("seen", "b"), CLEAR, APPEND].concat();
    let before = consume("before", "a");
    let plan = around_steps(&before, &inside, &consume("behind", "c"));
    slots_are_fed(&plan);
    // Settled before the first step is not settled before the second.
    let range = plan.steps[0].passes.clone();
    let seen = pass(&plan, "seen");
    let inside: Vec<usize> = range.clone().filter(|p| plan.passes[*p].path == "list (settle)").collect();
    assert_eq!(inside.len(), 1, "{:?}", paths(&plan));
    assert!(inside[0] < seen && range.contains(&seen));
    assert_eq!(arguments(&plan, inside[0])[0].slot, slot(&plan, seen));
    // And the one behind has its arguments even if no step runs.
    let behind = pass(&plan, "behind");
    let last = (range.end..behind).find(|p| plan.passes[*p].path == "list (settle)").expect("settled behind the steps");
    assert_eq!(arguments(&plan, last)[0].slot, slot(&plan, behind));
    assert_eq!(plan.passes[last].steps, None);
}

#[test]
fn a_reader_behind_steps_that_settled_has_arguments_of_its_own() {
    let inside = [CLEAR, APPEND, &consume("seen", "b")].concat();
    let plan = around_steps("", &inside, &consume("behind", "c"));
    slots_are_fed(&plan);
    let (range, behind) = (plan.steps[0].passes.clone(), pass(&plan, "behind"));
    let outside = (range.end..behind).find(|p| plan.passes[*p].path == "list (settle)");
    assert!(outside.is_some(), "a frame that runs no step would have none: {:?}", paths(&plan));
}

const MIPS: &str = r#""t": Texture(format: Rgba16Float, size: (8, 8), mips: Auto), "o": Texture(format: Rgba16Float, size: (8, 8)), "p": Texture(format: Rgba16Float, size: (8, 8))"#;

#[test]
fn mips_are_made_between_the_last_writer_and_the_first_reader() {
    let passes = r#"
        Clear(name: "m0", of: "t", mip: 0),
        Fullscreen(name: "paint", shader: "paint.wgsl", color: [(to: "t", blend: Add)]),
        Fullscreen(name: "one", shader: "sample.wgsl", color: ["o"], bind: {"src": "t"}),
        Fullscreen(name: "two", shader: "sample.wgsl", color: ["p"], bind: {"src": "t"}),"#;
    let plan = Test::of(MIPS, passes, r#""o""#).root("p").plan();
    assert_eq!(paths(&plan), ["paint", "t (mips)", "one", "two"]);
    let again = passes.replace(
        r#"Fullscreen(name: "two""#,
        r#"Fullscreen(name: "repaint", shader: "paint.wgsl", color: [(to: "t", blend: Add)]), Fullscreen(name: "two""#,
    );
    let plan = Test::of(MIPS, &again, r#""o""#).root("p").plan();
    assert_eq!(paths(&plan), ["paint", "t (mips)", "one", "repaint", "t (mips)", "two"]);
}

#[test]
fn arguments_that_a_shader_wrote_are_copied_to_a_slot() {
    let resources = r#""list": Buffer(items: 4), "o": Texture(format: Rgba16Float, size: (8, 8))"#;
    let passes = r#"
        Compute(name: "make", shader: "arguments.wgsl", each: Item("list"), bind: {"dst": "list"}),
        Draw(name: "one", shader: "triangle.wgsl", draw: Indirect(buffer: "list", item: 2), color: [(to: "o", clear: 0.0)]),
        Draw(name: "two", shader: "triangle.wgsl", draw: Indirect(buffer: "list"), color: ["o"]),"#;
    let plan = Test::of(resources, passes, r#""o""#).plan();
    assert_eq!(paths(&plan), ["make", "one (arguments)", "two (arguments)", "one", "two"]);
    slots_are_fed(&plan);
    let offsets: Vec<_> = plan
        .passes
        .iter()
        .filter_map(|pass| match pass.kind {
            PassKind::Arguments { offset, indexed, slot, .. } => Some((offset, indexed, slot)),
            _ => None,
        })
        .collect();
    assert_eq!(offsets, [(32, false, 0), (0, false, 1)]);
}

#[test]
fn mips_are_made_anew_in_each_step_that_changed_them_and_behind_the_steps() {
    let passes = r#"
        Clear(name: "m0", of: "t", mip: 0), Clear(name: "p0", of: "p"),
        Fullscreen(name: "one", shader: "sample.wgsl", color: ["o"], bind: {"src": "t"}),
        Steps(rate: 60, passes: [
            Fullscreen(name: "look", shader: "sample.wgsl", color: [(to: "p", blend: Add)], bind: {"src": "t"}),
            Fullscreen(name: "repaint", shader: "paint.wgsl", color: [(to: "t", blend: Add)]),
        ]),
        Fullscreen(name: "two", shader: "sample.wgsl", color: [(to: "q")], bind: {"src": "t"}),"#;
    let resources = format!(r#"{MIPS}, "q": Texture(format: Rgba16Float, size: (8, 8))"#);
    let plan = Test::of(&resources, passes, r#""o""#).root("p").root("q").plan();
    // The first step would find them made, the second one would not.
    let expected = ["m0", "p0", "t (mips)", "one", "t (mips)", "look", "repaint", "t (mips)", "two"];
    assert_eq!(paths(&plan), expected);
    assert_eq!(plan.steps[0].passes, 4..7);
    assert_eq!((plan.passes[2].steps, plan.passes[4].steps, plan.passes[7].steps), (None, Some(0), None));
}

#[test]
fn what_is_handed_in_is_made_for_what_the_engine_does_with_it() {
    let graph = r#"Graph(
        inputs: { "cleared": Buffer, "filled": Buffer, "copied": Texture, "drawn": Texture, "read": Buffer },
        resources: { "out": Buffer(items: 64), "other": Texture(format: Rgba8Unorm, size: (8, 8)) },
        passes: [
            Clear(of: "cleared"), Clear(of: "filled", value: 3), Clear(of: "drawn", value: 0.5),
            Copy(from: "copied", to: "other"),
            Compute(name: "use", shader: "copy.wgsl", each: Item("out"), bind: {"src": "read", "dst": "out"}),
        ],
        outputs: ["out", "cleared", "filled", "drawn", "other"],
    )"#;
    let buffer = InputInfo::Buffer { items: 64, stride: 4 };
    let texture = InputInfo::Texture(texture(TextureFormat::Rgba8Unorm));
    let test =
        ["cleared", "filled", "read"].iter().fold(Test::new(graph), |test, name| test.input(name, buffer.clone()));
    let test = test.input("copied", texture.clone()).input("drawn", texture);
    let plan = ["cleared", "filled", "drawn", "other"].iter().fold(test, |test, name| test.root(name)).plan();
    let usages = |name: &str| match plan.needs(name).unwrap().1 {
        ObjectKind::Buffer(buffer) => format!("{:?}", buffer.usages),
        ObjectKind::Texture(texture) => format!("{:?}", texture.usages),
    };
    assert_eq!(usages("cleared"), "BufferUsages(COPY_DST)");
    assert_eq!(usages("filled"), "BufferUsages(STORAGE)");
    assert_eq!(usages("read"), "BufferUsages(STORAGE)");
    assert_eq!(usages("copied"), "TextureUsages(COPY_SRC)");
    assert_eq!(usages("drawn"), "TextureUsages(RENDER_ATTACHMENT)");
}
