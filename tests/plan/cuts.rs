//! Where a frame is cut so that memory can be given back in the middle of it.

use meniscus::plan::model::{MemoryRequest, Plan, Policy, Slot, Why};

use super::memory::{compare, hold};
use crate::planning::{Test, object, pass};

const TEXELS: u64 = 64 * 64;

/// `large` (16 bytes a texel) and then `other` (8 bytes, another size) are live at once with little
/// else: no two textures are alike.
fn graph(passes: &str) -> Test {
    let resources = r#""large": Texture(format: Rgba32Float, size: (64, 64)), "a": Texture(format: Rgba8Unorm, size: (8, 8)),
        "other": Texture(format: Rgba32Float, size: (128, 32)), "out": Texture(format: Rgba16Float, size: (8, 8)),
        "seen": Texture(format: Rg32Float, size: (16, 16))"#;
    Test::of(resources, passes, r#""out", "seen""#)
}

fn filter(dst: &str, src: &str) -> String {
    format!(r#"Fullscreen(name: "{dst}", shader: "filter.wgsl", color: ["{dst}"], bind: {{"src": "{src}"}}),"#)
}

fn chain() -> String {
    let paint = r#"Fullscreen(name: "large", shader: "paint.wgsl", color: ["large"]),"#.to_owned();
    [paint, filter("a", "large"), filter("other", "a"), filter("out", "other"), filter("seen", "out")].concat()
}

fn plan() -> Plan {
    graph(&chain()).root("seen").plan()
}

#[test]
fn a_frame_is_cut_where_the_next_would_be_too_much() {
    let plan = plan();
    hold(&plan);
    compare(&plan);
    let memory = &plan.memory;
    let slot = |name: &str| {
        let bytes = meniscus::plan::memory::bytes(&plan.objects[object(&plan, name)].kind);
        memory.smallest.iter().position(|s| *s == Slot { objects: vec![object(&plan, name)], bytes }).unwrap()
    };
    let [cut] = memory.cuts.as_slice() else { panic!("{:?}", memory.cuts) };
    assert_eq!(cut.before, pass(&plan, "other"));
    assert_eq!(cut.gives, [slot("large")]);
    // The picture, `out`, is there all the time.
    assert_eq!(cut.makes, [slot("other"), slot("seen")]);
    let (small, out, seen) = (64 * 4, 64 * 8, 256 * 8);
    assert_eq!(memory.parts, [TEXELS * 16 + small + out, TEXELS * 16 + small + out + seen]);
    assert_eq!(memory.of_frame(Policy::Share), TEXELS * 32 + small + out + seen);
    assert_eq!(memory.of_frame(Policy::Smallest), memory.parts[1]);
    assert!(memory.cuts(Policy::Share).is_empty() && memory.cuts(Policy::Keep).is_empty());
}

fn is_caught(plan: &Plan) -> bool {
    std::panic::catch_unwind(|| hold(plan)).is_err()
}

#[test]
fn planted_faults_are_caught() {
    assert!(!is_caught(&plan()));
    let mut early = plan();
    early.memory.cuts[0].before -= 1;
    assert!(is_caught(&early), "memory that is given back one pass too early");
    let mut kept = plan();
    kept.memory.cuts[0].gives.clear();
    assert!(is_caught(&kept), "memory that is not given back");
    let mut late = plan();
    late.memory.cuts[0].before += 1;
    assert!(is_caught(&late), "memory that is made one pass too late");
    let mut twice = plan();
    twice.memory.cuts.push(twice.memory.cuts[0].clone());
    assert!(is_caught(&twice), "memory that is given back twice");
}

#[test]
fn passes_that_belong_together_are_not_parted() {
    // `other` begins within the steps, in front of which the cut lies.
    let paint = |dst: &str| format!(r#"Fullscreen(name: "{dst}", shader: "paint.wgsl", color: ["{dst}"]),"#);
    let count = r#"Compute(name: "count", shader: "add.wgsl", each: Item("t"), bind: {"dst": "t"}),"#;
    let show =
        r#"Compute(name: "shown", shader: "copy.wgsl", each: Item("shown"), bind: {"src": "t", "dst": "shown"}),"#;
    let before = [paint("large"), filter("a", "large")].concat();
    let inside = [count.to_owned(), paint("other"), filter("s", "other")].concat();
    let behind = [filter("seen", "a"), filter("out", "s"), show.to_owned()].concat();
    let graph = format!(
        r#"Graph(
            state: {{ "s": Texture(format: Rgba8Unorm, size: (8, 8)), "t": Buffer(items: 8) }},
            resources: {{ "large": Texture(format: Rgba32Float, size: (64, 64)), "a": Texture(format: Rgba8Unorm, size: (8, 8)),
                "other": Texture(format: Rgba32Float, size: (128, 32)), "out": Texture(format: Rgba16Float, size: (8, 8)),
                "seen": Texture(format: Rg32Float, size: (16, 16)), "shown": Buffer(items: 8) }},
            passes: [{before} Steps(rate: 60, passes: [{inside}]), {behind}],
            outputs: ["out", "seen", "shown"],
        )"#
    );
    let plan = Test::new(&graph).root("seen").root("shown").plan();
    hold(&plan);
    compare(&plan);
    assert_eq!(plan.memory.cuts.len(), 1);
    let inside = &plan.steps[0].passes;
    let before = plan.memory.cuts[0].before;
    assert_eq!(before, inside.start, "the cut lies in front of {inside:?}");
    assert!(plan.objects[object(&plan, "other")].lifetime.unwrap().0 > before);
}

#[test]
fn a_budget_takes_the_first_policy_that_keeps_to_it_with_as_few_cuts_as_it_can() {
    let whole = plan();
    let [share, smallest] = [Policy::Share, Policy::Smallest].map(|policy| whole.memory.held(policy));
    assert_eq!(whole.memory.held(Policy::Keep), share, "nothing is alike");
    let within = |budget: u64| {
        let mut test = graph(&chain()).root("seen");
        test.request.memory = MemoryRequest { budget: Some(budget), ..MemoryRequest::default() };
        test.try_plan().map(|plan| (plan.memory.policy, plan.memory.why, plan.memory.cuts.len())).ok()
    };
    assert_eq!(within(share), Some((Policy::Keep, Why::Still, 1)));
    assert_eq!(within(share - 1), Some((Policy::Smallest, Why::Budget { keeping: share }, 1)));
    assert_eq!(within(smallest), Some((Policy::Smallest, Why::Budget { keeping: share }, 1)));
    assert_eq!(within(smallest - 1), Some((Policy::Smallest, Why::Budget { keeping: share }, 2)));
    assert_eq!(within(whole.memory.lower_bound - 1), None);
}

#[test]
fn what_is_small_beside_the_rest_needs_no_cut() {
    let plan = Test::of(
        r#""a": Texture(format: Rgba16Float, size: (64, 64)), "b": Texture(format: Rgba8Unorm, size: (8, 8)),
           "out": Texture(format: Rgba16Float, size: (64, 64))"#,
        &[
            r#"Fullscreen(name: "a", shader: "paint.wgsl", color: ["a"]),"#.to_owned(),
            filter("b", "a"),
            filter("out", "b"),
        ]
        .concat(),
        r#""out""#,
    )
    .plan();
    assert!(plan.memory.cuts.is_empty());
    assert_eq!(plan.memory.smallest, plan.memory.share);
    assert_eq!(plan.memory.policy, Policy::Keep);
}
