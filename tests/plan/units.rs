//! Units and their causes (rule 37).

use std::collections::BTreeSet;

use meniscus::format::TextureFormat;
use meniscus::plan::model::{Causes, InputInfo, Plan};

use crate::planning::{Test, pass, texture};

fn unit(plan: &Plan, path: &str) -> usize {
    plan.passes[pass(plan, path)].unit
}

fn causes<'a>(plan: &'a Plan, path: &str) -> &'a Causes {
    &plan.units[unit(plan, path)].causes
}

fn set(names: &[&str]) -> BTreeSet<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// Something of each kind of cause, and one that has them all.
fn each_kind() -> Plan {
    let graph = r#"Graph(
        inputs: { "camera": Camera, "picture": Texture, "light": Texture(optional: true) },
        params: { "gain": Float(default: 1.0, min: 0.0, max: 9.0), "other": Int(default: 2, min: 0, max: 4), "fancy": Bool(default: true) },
        let: { "half": "other + 1" },
        resources: {
            "eye": Buffer(items: 64), "clock": Buffer(items: 64), "gained": Buffer(items: 64), "fixed": Buffer(items: 64),
            "wide": Buffer(items: "viewport.x"), "sized": Buffer(items: "half"), "chosen": Buffer(items: 64),
            "seen": Texture(format: Rgba16Float, size: (8, 8)), "asked": Buffer(items: 64),
            "m1": Buffer(items: 64), "m2": Buffer(items: 64), "o": Buffer(items: 64),
        },
        passes: [
            Compute(name: "eye", shader: "eye.wgsl", each: Item("eye"), bind: {"dst": "eye"}),
            Compute(name: "clock", shader: "clock.wgsl", each: Item("clock"), bind: {"dst": "clock"}),
            Compute(name: "gain", shader: "gain.wgsl", each: Item("gained"), bind: {"dst": "gained"}),
            Clear(name: "fixed", of: "fixed"),
            Clear(name: "wide", of: "wide"),
            Clear(name: "sized", of: "sized"),
            If(test: "fancy", then: [ Clear(name: "chosen", of: "chosen") ], else: [ Clear(name: "plain", of: "chosen") ]),
            If(test: "has(light)", then: [ Clear(name: "asked", of: "asked") ], else: [ Clear(name: "unasked", of: "asked") ]),
            Fullscreen(name: "look", shader: "filter.wgsl", color: ["seen"], bind: {"src": "picture"}),
            Compute(name: "m1", shader: "mix.wgsl", each: Item("m1"), bind: {"left": "eye", "right": "gained", "dst": "m1"}),
            Compute(name: "m2", shader: "mix.wgsl", each: Item("m2"), bind: {"left": "m1", "right": "clock", "dst": "m2"}),
            Copy(name: "o", from: "fixed", to: "o"),
        ],
        outputs: ["o"],
    )"#;
    let picture = texture(TextureFormat::Rgba16Float);
    let test = Test::new(graph).input("camera", InputInfo::Camera).input("picture", InputInfo::Texture(picture));
    ["eye", "clock", "wide", "sized", "chosen", "asked", "seen", "m2"]
        .iter()
        .fold(test, |test, root| test.root(root))
        .plan()
}

#[test]
fn a_cause_is_what_a_unit_reads_from_outside_and_nothing_else() {
    let plan = each_kind();
    let live = |names: &[&str]| Causes { live: set(names), ..Causes::default() };
    let params = |names: &[&str]| Causes { params: set(names), ..Causes::default() };
    assert_eq!(*causes(&plan, "eye"), live(&["camera.position"]));
    assert_eq!(*causes(&plan, "clock"), live(&["time"]));
    assert_eq!(*causes(&plan, "gain"), params(&["gain"]));
    assert_eq!(*causes(&plan, "fixed"), Causes::default());
    assert_eq!(*causes(&plan, "wide"), Causes { viewport: true, ..Causes::default() });
    assert_eq!(*causes(&plan, "sized"), params(&["other"]));
    assert_eq!(*causes(&plan, "chosen"), params(&["fancy"]));
    assert_eq!(*causes(&plan, "unasked"), Causes { inputs: set(&["light"]), ..Causes::default() });
    assert_eq!(*causes(&plan, "look"), Causes { inputs: set(&["picture"]), ..Causes::default() });
}

#[test]
fn causes_are_closed_over_what_is_read() {
    let plan = each_kind();
    let both = Causes { live: set(&["camera.position"]), params: set(&["gain"]), ..Causes::default() };
    assert_eq!(*causes(&plan, "m1"), both);
    let all = Causes { live: set(&["camera.position", "time"]), params: set(&["gain"]), ..Causes::default() };
    assert_eq!(*causes(&plan, "m2"), all);
    assert_eq!(*causes(&plan, "o"), Causes::default(), "what reads nothing that changes runs once");
}

fn abc(passes: &str, output: &str) -> Plan {
    let resources = r#""a": Buffer(items: 64), "b": Buffer(items: 64), "c": Buffer(items: 64), "d": Buffer(items: 64)"#;
    Test::of(resources, passes, output).plan()
}

fn copy(name: &str, src: &str, dst: &str) -> String {
    format!(
        r#"Compute(name: "{name}", shader: "copy.wgsl", each: Item("{dst}"), bind: {{"src": "{src}", "dst": "{dst}"}}),"#
    )
}

const FILL: &str = r#"Compute(name: "fill", shader: "fill.wgsl", each: Item("a"), bind: {"dst": "a"}),"#;
const ADD: &str = r#"Compute(name: "add", shader: "add.wgsl", each: Item("a"), bind: {"dst": "a"}),"#;

#[test]
fn all_writers_of_a_resource_are_one_unit_and_readers_of_the_last_version_are_not() {
    let plan = abc(&[FILL, ADD, &copy("read", "a", "b")].concat(), r#""b""#);
    assert_eq!(unit(&plan, "fill"), unit(&plan, "add"));
    assert_ne!(unit(&plan, "read"), unit(&plan, "add"));
    assert_eq!(plan.units[0].passes, [0, 1]);
}

#[test]
fn a_reader_of_an_earlier_version_belongs_to_the_writers() {
    let plan =
        abc(&[FILL, &copy("early", "a", "b"), ADD, &copy("late", "a", "c"), &copy("sum", "b", "d")].concat(), r#""d""#);
    // Nobody needs the later version here.
    assert_eq!(plan.passes.len(), 3);
    let resources = r#""a": Buffer(items: 64), "b": Buffer(items: 64), "c": Buffer(items: 64), "d": Buffer(items: 64)"#;
    let passes = [FILL, &copy("early", "a", "b"), ADD, &copy("late", "a", "c"), &copy("sum", "b", "d")].concat();
    let plan = Test::of(resources, &passes, r#""d""#).root("c").plan();
    assert_eq!(unit(&plan, "early"), unit(&plan, "fill"));
    assert_eq!(unit(&plan, "add"), unit(&plan, "fill"));
    assert_ne!(unit(&plan, "late"), unit(&plan, "fill"));
    assert_ne!(unit(&plan, "sum"), unit(&plan, "fill"));
}

#[test]
fn names_that_swap_are_one_unit() {
    let passes = [
        FILL,
        r#"Repeat(times: 3, swap: [("a", "b")], passes: ["#,
        &copy("turn", "a", "b"),
        "]),",
        &copy("read", "a", "c"),
    ];
    let plan = abc(&passes.concat(), r#""c""#);
    let one: BTreeSet<usize> = plan.passes[..4].iter().map(|p| p.unit).collect();
    assert_eq!(one.len(), 1);
    assert_ne!(unit(&plan, "read"), unit(&plan, "fill"));
}

#[test]
fn the_passes_of_steps_are_one_unit_that_runs_for_its_step() {
    let graph = r#"Graph(
        state: { "s": Buffer(items: 8), "t": Buffer(items: 8) },
        resources: { "out": Buffer(items: 8) },
        passes: [
            Steps(rate: 60, passes: [
                Compute(name: "one", shader: "add.wgsl", each: Item("s"), bind: {"dst": "s"}),
                Compute(name: "two", shader: "copy.wgsl", each: Item("t"), bind: {"src": "s", "dst": "t"}),
            ]),
            Copy(name: "show", from: "t", to: "out"),
        ],
        outputs: ["out"],
    )"#;
    let plan = Test::new(graph).plan();
    assert_eq!(unit(&plan, "one"), unit(&plan, "two"));
    assert_eq!(causes(&plan, "one").live, set(&["step"]));
    assert_eq!(causes(&plan, "show").live, set(&["step"]));
    assert_ne!(unit(&plan, "one"), unit(&plan, "show"));
}

#[test]
fn settling_what_somebody_hands_in_runs_for_its_version() {
    let graph = r#"Graph(
        inputs: { "list": Counted },
        resources: { "a": Buffer(items: 64) },
        passes: [
            Clear(name: "zero", of: "a"),
            Compute(name: "use", shader: "consume.wgsl", each: Item("list"), bind: {"dst": "a"}),
        ],
        outputs: ["a"],
    )"#;
    let plan = Test::new(graph).input("list", InputInfo::Buffer { items: 9, stride: 4 }).plan();
    assert_eq!(causes(&plan, "list (settle)").inputs, set(&["list"]));
    assert_eq!(causes(&plan, "use").inputs, set(&["list"]));
}

#[test]
fn units_are_numbered_by_their_first_pass() {
    let plan = each_kind();
    let mut seen = 0;
    for pass in &plan.passes {
        assert!(pass.unit <= seen, "{} is in unit {} and {seen} would be next", pass.path, pass.unit);
        seen = seen.max(pass.unit + 1);
    }
    assert_eq!(seen, plan.units.len());
    for (u, unit) in plan.units.iter().enumerate() {
        assert!(unit.passes.iter().all(|p| plan.passes[*p].unit == u) && unit.passes.is_sorted());
    }
}

#[test]
fn what_the_order_of_atomics_reaches_is_marked() {
    let resources =
        r#""total": Buffer(items: 1), "a": Buffer(items: 64), "b": Buffer(items: 64), "c": Buffer(items: 64)"#;
    let passes = [
        r#"Clear(name: "zero", of: "total"),
        Compute(name: "number", shader: "atomic.wgsl", each: Item("a"), bind: {"dst": "a"}),"#,
        &copy("after", "a", "b"),
        r#"Clear(name: "calm", of: "c"),"#,
    ];
    let plan = Test::of(resources, &passes.concat(), r#""b""#).root("c").plan();
    let marked: Vec<bool> =
        ["zero", "number", "after", "calm"].map(|path| plan.passes[pass(&plan, path)].unordered).into();
    assert_eq!(marked, [false, true, true, false]);
}

#[test]
fn what_was_read_before_the_atomics_or_made_anew_behind_them_is_not_marked() {
    let resources =
        r#""total": Buffer(items: 64), "a": Buffer(items: 64), "b": Buffer(items: 64), "c": Buffer(items: 64)"#;
    let number = |name: &str| {
        format!(r#"Compute(name: "{name}", shader: "atomic.wgsl", each: Item("a"), bind: {{"dst": "a"}}),"#)
    };
    let passes = [
        r#"Clear(name: "zero", of: "total"),"#,
        &copy("before", "total", "b"),
        &number("number"),
        &copy("behind", "a", "c"),
        r#"Compute(name: "anew", shader: "fill.wgsl", each: Item("a"), bind: {"dst": "a"}),"#,
        &copy("calm", "a", "d"),
    ]
    .concat();
    let resources = format!(r#"{resources}, "d": Buffer(items: 64)"#);
    let plan = Test::of(&resources, &passes, r#""b""#).root("c").root("d").plan();
    let marked: Vec<bool> = plan.passes.iter().map(|p| p.unordered).collect();
    assert_eq!(marked, [false, false, true, true, false, false], "{:?}", crate::planning::paths(&plan));
}
