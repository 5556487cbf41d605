//! What nobody needs is left out and said.

use crate::planning::{Test, culled, object, paths};

/// A pass that fills a buffer.
fn fill(name: &str, dst: &str) -> String {
    format!(r#"Compute(name: "{name}", shader: "fill.wgsl", each: Item("{dst}"), bind: {{"dst": "{dst}"}}),"#)
}

fn with(shader: &str, name: &str, dst: &str, src: &str) -> String {
    format!(
        r#"Compute(name: "{name}", shader: "{shader}", each: Item("{dst}"), bind: {{"dst": "{dst}", "src": "{src}"}}),"#
    )
}

const AB: &str = r#""a": Buffer(items: 100), "b": Buffer(items: 100), "c": Buffer(items: 100)"#;

#[test]
fn what_no_output_needs_is_left_out_and_said() {
    let passes = [fill("one", "a"), fill("two", "b"), with("copy.wgsl", "three", "c", "b")].concat();
    let plan = Test::of(AB, &passes, r#""a""#).plan();
    assert_eq!(paths(&plan), ["one"]);
    assert_eq!(culled(&plan), ["two", "three"]);
    assert_eq!(plan.culled[0].why, "no output needs `b`");
    assert_eq!(plan.objects[object(&plan, "b")].lifetime, None);
}

#[test]
fn only_the_first_output_and_what_is_asked_for_are_roots() {
    let passes = [fill("one", "a"), fill("two", "b"), fill("three", "c")].concat();
    assert_eq!(paths(&Test::of(AB, &passes, r#""a", "b""#).plan()), ["one"]);
    assert_eq!(paths(&Test::of(AB, &passes, r#""a", "b""#).root("b").plan()), ["one", "two"]);
    assert_eq!(paths(&Test::of(AB, &passes, r#""a", "b""#).root("c").plan()), ["one", "three"]);
}

#[test]
fn a_whole_write_makes_earlier_ones_needless() {
    let passes = [fill("early", "a"), fill("late", "a")].concat();
    let plan = Test::of(AB, &passes, r#""a""#).plan();
    assert_eq!((paths(&plan), culled(&plan)), (vec!["late"], vec!["early"]));
}

#[test]
fn a_write_that_somebody_read_in_between_is_needed() {
    let passes = [
        fill("early", "a"),
        with("copy.wgsl", "between", "b", "a"),
        fill("late", "a"),
        with("copy.wgsl", "end", "c", "b"),
    ];
    assert_eq!(paths(&Test::of(AB, &passes.concat(), r#""c""#).plan()), ["early", "between", "end"]);
    assert_eq!(paths(&Test::of(AB, &passes.concat(), r#""c""#).root("a").plan()), ["early", "between", "late", "end"]);
}

#[test]
fn what_keeps_the_content_needs_the_earlier_writer() {
    let add = r#"Compute(name: "more", shader: "add.wgsl", each: Item("a"), bind: {"dst": "a"}),"#;
    let passes = [fill("early", "a"), add.to_owned()].concat();
    assert_eq!(paths(&Test::of(AB, &passes, r#""a""#).plan()), ["early", "more"]);
}

/// As many threads as were counted write no whole buffer, and none if nothing was counted.
#[test]
fn what_a_count_drives_writes_nothing_whole() {
    const LIST: &str = r#""a": Buffer(items: 100), "list": Counted(capacity: 10)"#;
    let passes = [
        fill("early", "a"),
        r#"Clear(name: "empty", of: "list"), Compute(name: "append", shader: "append.wgsl", each: Threads(10)),"#
            .into(),
        r#"Compute(name: "late", shader: "consume.wgsl", each: Item("list"), bind: {"dst": "a"}),"#.into(),
    ];
    let plan = Test::of(LIST, &passes.concat(), r#""a""#).plan();
    assert!(paths(&plan).contains(&"early") && culled(&plan).is_empty(), "{:?}", culled(&plan));
}

/// A draw that clears depth alone still sees the stencil that was there.
#[test]
fn clearing_one_aspect_keeps_the_other() {
    const TARGETS: &str =
        r#""t": Texture(format: Rgba16Float, size: (8, 8)), "z": Texture(format: Depth24PlusStencil8, size: (8, 8))"#;
    let passes = |stencil: &str| {
        format!(
            r#"Clear(name: "zero", of: "z", value: 0.5),
            Draw(name: "draw", shader: "triangle.wgsl", vertices: 3, color: [(to: "t", clear: 0.0)],
                depth: Depth(to: "z", compare: Always, write: true, clear: 0.0{stencil})),"#
        )
    };
    let run = |stencil: &str| paths(&Test::of(TARGETS, &passes(stencil), r#""t""#).plan()).join(" ");
    assert_eq!(run(", stencil: (compare: Equal, reference: 3)"), "zero draw");
    assert_eq!(run(", stencil: (compare: Equal, reference: 3, clear: 0)"), "draw");
}

const LAYERS: &str =
    r#""t": Texture(format: Rgba16Float, size: (8, 8), layers: 2), "o": Texture(format: Rgba16Float, size: (8, 8))"#;

#[test]
fn layers_are_told_apart() {
    let passes = r#"
        Clear(name: "zero", of: "t", layer: 0), Clear(name: "one", of: "t", layer: 1),
        Fullscreen(name: "paint", shader: "paint.wgsl", color: [(to: "t", layer: 0)]),
        Fullscreen(name: "read", shader: "layers.wgsl", color: ["o"], bind: {"src": "t"}),"#;
    let plan = Test::of(LAYERS, passes, r#""o""#).plan();
    // The painting covers all of layer 0 and nothing of layer 1.
    assert_eq!((paths(&plan), culled(&plan)), (vec!["one", "paint", "read"], vec!["zero"]));
}

#[test]
fn a_clear_of_the_whole_makes_layers_needless_and_a_clear_of_a_layer_does_not() {
    let whole = r#"Clear(name: "part", of: "t", layer: 0), Clear(name: "all", of: "t"),"#;
    assert_eq!(paths(&Test::of(LAYERS, whole, r#""t""#).plan()), ["all"]);
    let part = r#"Clear(name: "all", of: "t"), Clear(name: "part", of: "t", layer: 0),"#;
    assert_eq!(paths(&Test::of(LAYERS, part, r#""t""#).plan()), ["all", "part"]);
    let both = r#"Clear(name: "all", of: "t"), Clear(name: "zero", of: "t", layer: 0), Clear(name: "one", of: "t", layer: 1),"#;
    assert_eq!(paths(&Test::of(LAYERS, both, r#""t""#).plan()), ["zero", "one"]);
}

#[test]
fn mips_are_told_apart() {
    let resources =
        r#""t": Texture(format: Rgba16Float, size: (8, 8), mips: 3), "o": Texture(format: Rgba16Float, size: (8, 8))"#;
    let passes = r#"
        Clear(name: "m0", of: "t", mip: 0), Clear(name: "m1", of: "t", mip: 1), Clear(name: "m2", of: "t", mip: 2),
        Fullscreen(name: "read", shader: "filter.wgsl", color: ["o"], bind: {"src": View(of: "t", mip: 1)}),"#;
    let plan = Test::of(resources, passes, r#""o""#).plan();
    assert_eq!((paths(&plan), culled(&plan)), (vec!["m1", "read"], vec!["m0", "m2"]));
}

#[test]
fn a_target_that_loads_or_blends_keeps_what_was_there() {
    let resources = r#""o": Texture(format: Rgba16Float, size: (8, 8))"#;
    let over = |how: &str| {
        format!(
            r#"Clear(name: "before", of: "o"), Fullscreen(name: "paint", shader: "paint.wgsl", color: [(to: "o", {how})]),"#
        )
    };
    assert_eq!(paths(&Test::of(resources, &over(""), r#""o""#).plan()), ["paint"]);
    for kept in ["blend: Add", r#"write: "r""#] {
        let plan = Test::of(resources, &over(kept), r#""o""#).plan();
        assert_eq!((paths(&plan), plan.order.folded.len(), culled(&plan).len()), (vec!["paint"], 1, 0), "{kept}");
    }
    assert_eq!(paths(&Test::of(resources, &over("blend: Add, clear: 0.0"), r#""o""#).plan()), ["paint"]);
}

/// `s` is what was, `n` is what is; `n` is copied to `s` for the next step at the end.
const STATE: &str = r#"Graph(
    state: { "s": Buffer(items: 8) },
    resources: { "n": Buffer(items: 8), "seen": Buffer(items: 8), "out": Buffer(items: 8) },
    passes: [
        Clear(name: "none", of: "seen"),
        Steps(rate: 60, passes: [
            Compute(name: "step", shader: "step.wgsl", each: Item("n"), bind: {"src": "s", "dst": "n"}),
            Copy(name: "keep", from: "n", to: "s"),
        ]),
        READER
    ],
    outputs: ["out"],
)"#;

#[test]
fn state_that_the_next_step_reads_is_kept_alive() {
    let reader = r#"Compute(name: "show", shader: "copy.wgsl", each: Item("out"), bind: {"src": "s", "dst": "out"}),"#;
    let plan = Test::new(&STATE.replace("READER", reader)).plan();
    assert_eq!(paths(&plan), ["step", "keep", "show"]);
    // Nobody looks at the state: then no step runs at all.
    let blind = r#"Compute(name: "show", shader: "fill.wgsl", each: Item("out"), bind: {"dst": "out"}),"#;
    let plan = Test::new(&STATE.replace("READER", blind)).plan();
    assert_eq!((paths(&plan), culled(&plan)), (vec!["show"], vec!["none", "step", "keep"]));
    assert!(plan.steps[0].passes.is_empty());
}

#[test]
fn a_whole_write_in_a_step_does_not_make_earlier_ones_needless() {
    // A frame may run no step: then what is shown is what the clear left.
    let graph = r#"Graph(
        state: { "s": Buffer(items: 8) },
        resources: { "seen": Buffer(items: 8), "out": Buffer(items: 8) },
        passes: [
            Clear(name: "none", of: "seen"),
            Steps(rate: 60, passes: [
                Compute(name: "step", shader: "add.wgsl", each: Item("s"), bind: {"dst": "s"}),
                Copy(name: "look", from: "s", to: "seen"),
            ]),
            Copy(name: "show", from: "seen", to: "out"),
        ],
        outputs: ["out"],
    )"#;
    assert_eq!(paths(&Test::new(graph).plan()), ["none", "step", "look", "show"]);
}

#[test]
fn what_one_step_hands_to_the_next_is_needed() {
    let graph = |order: &str| {
        format!(
            r#"Graph(
            state: {{ "s": Buffer(items: 8) }},
            resources: {{ "hand": Buffer(items: 8), "out": Buffer(items: 8) }},
            passes: [
                Clear(name: "none", of: "hand"),
                Steps(rate: 60, passes: [ {order} ]),
                Copy(name: "show", from: "s", to: "out"),
            ],
            outputs: ["out"],
        )"#
        )
    };
    let take = r#"Copy(name: "take", from: "hand", to: "s"),"#;
    let give = r#"Compute(name: "give", shader: "fill.wgsl", each: Item("hand"), bind: {"dst": "hand"}),"#;
    let plan = Test::new(&graph(&[take, give].concat())).plan();
    assert_eq!(paths(&plan), ["none", "take", "give", "show"]);
    // Written before it is read and again behind: that no step sees.
    let again = give.replace("give", "again");
    let plan = Test::new(&graph(&[give, take, &again].concat())).plan();
    assert_eq!((paths(&plan), culled(&plan)), (vec!["none", "give", "take", "show"], vec!["again"]));
}
