//! Program order: branches, loops, swaps, counters, steps and rings.

use meniscus::graph::value::Value;
use meniscus::plan::model::{Bound, ObjectRef, Plan, UniformValue};

use crate::planning::{Test, bound, bound_path, object, pass, paths, shader};

#[test]
fn a_read_sees_the_last_write_before_it() {
    let passes = r#"
        Compute(name: "one", shader: "fill.wgsl", each: Item("a"), bind: {"dst": "a"}),
        Compute(name: "two", shader: "copy.wgsl", each: Item("b"), bind: {"src": "a", "dst": "b"}),
        Compute(name: "three", shader: "add.wgsl", each: Item("a"), bind: {"dst": "a"}),
        Compute(name: "four", shader: "mix.wgsl", each: Item("c"), bind: {"left": "a", "right": "b", "dst": "c"}),"#;
    let resources = r#""a": Buffer(items: 8), "b": Buffer(items: 8), "c": Buffer(items: 8)"#;
    // `mix` sees numbers of another type: said as such, not as a wrong order.
    assert!(Test::of(resources, passes, r#""c""#).try_plan().is_err());
    let passes = passes.replace("mix.wgsl", "copy.wgsl").replace(r#""left": "a", "right": "b""#, r#""src": "a""#);
    assert_eq!(paths(&Test::of(resources, &passes, r#""c""#).plan()), ["one", "three", "four"]);
    let all = Test::of(resources, &passes, r#""c""#).root("b").plan();
    assert_eq!(paths(&all), ["one", "two", "three", "four"]);
}

#[test]
fn a_branch_contributes_the_one_taken() {
    let graph = r#"Graph(
        params: { "fancy": Bool(default: true) },
        resources: { "a": Buffer(items: 8) },
        passes: [ If(test: "fancy", then: [
            Compute(name: "then", shader: "fill.wgsl", each: Item("a"), bind: {"dst": "a"}),
        ], else: [
            Clear(name: "else", of: "a"),
        ]) ],
        outputs: ["a"],
    )"#;
    let fancy = Test::new(graph).plan();
    let plain = Test::new(graph).param("fancy", Value::Bool(false)).plan();
    assert_eq!((paths(&fancy), paths(&plain)), (vec!["then"], vec!["else"]));
    for plan in [&fancy, &plain] {
        assert_eq!(plan.units[0].causes.params, ["fancy".to_owned()].into());
        assert!(plan.culled.is_empty(), "a branch that is not taken is not culled: it is not there");
    }
}

/// `a` is filled, then as often as asked the last name is made from the first and they rotate.
fn rotating(names: &[&str], times: i64) -> Plan {
    let resources: String = names.iter().map(|n| format!(r#""{n}": Buffer(items: 8),"#)).collect();
    let tuple: Vec<String> = names.iter().map(|n| format!("{n:?}")).collect();
    let (tuple, last) = (tuple.join(", "), names[names.len() - 1]);
    let graph = format!(
        r#"Graph(
        params: {{ "times": Int(default: 0, min: 0, max: 9) }},
        resources: {{ {resources} "out": Buffer(items: 8) }},
        passes: [
            Compute(name: "first", shader: "fill.wgsl", each: Item("a"), bind: {{"dst": "a"}}),
            Repeat(times: "times", swap: [({tuple})], passes: [
                Compute(name: "turn", shader: "copy.wgsl", each: Item("a"), bind: {{"src": "a", "dst": "{last}"}}),
            ]),
            Compute(name: "last", shader: "copy.wgsl", each: Item("out"), bind: {{"src": "a", "dst": "out"}}),
        ],
        outputs: ["out"],
    )"#
    );
    Test::new(&graph).param("times", Value::Int(times)).plan()
}

#[test]
fn after_a_loop_the_first_name_has_the_newest() {
    for times in 0..6 {
        let plan = rotating(&["a", "b"], times);
        assert_eq!(plan.passes.len(), times as usize + 2);
        // The last pass reads what the last iteration wrote, whatever it is called.
        let newest = match times {
            0 => bound(&plan, 0, "dst"),
            n => bound(&plan, pass(&plan, &format!("turn[{}]", n - 1)), "dst"),
        };
        let last = pass(&plan, "last");
        assert_eq!(bound(&plan, last, "src"), newest, "{times} iterations");
        assert_eq!(bound_path(&plan, last, "src"), if times % 2 == 0 { "a" } else { "b" });
        assert_eq!(plan.names["a"], newest);
        // No iteration reads what it writes, and each reads what the one before wrote.
        for i in 0..times {
            let now = pass(&plan, &format!("turn[{i}]"));
            assert_ne!(bound(&plan, now, "src"), bound(&plan, now, "dst"));
            let before = if i == 0 { 0 } else { pass(&plan, &format!("turn[{}]", i - 1)) };
            assert_eq!(bound(&plan, now, "src"), bound(&plan, before, "dst"));
        }
    }
}

#[test]
fn three_names_rotate() {
    for (times, newest, now) in [
        (0, "a", ["a", "b", "c"]),
        (1, "c", ["c", "a", "b"]),
        (2, "b", ["b", "c", "a"]),
        (3, "a", ["a", "b", "c"]),
        (4, "c", ["c", "a", "b"]),
    ] {
        let plan = rotating(&["a", "b", "c"], times);
        assert_eq!(bound_path(&plan, pass(&plan, "last"), "src"), newest, "{times} iterations");
        if times > 0 {
            let behind = ["a", "b", "c"].map(|name| match plan.names[name] {
                ObjectRef::Fixed(id) => plan.objects[id].path.as_str(),
                ObjectRef::Ring { .. } => "a ring",
            });
            assert_eq!(behind, now, "{times} iterations");
        }
    }
}

#[test]
fn a_counter_is_a_number_in_each_iteration() {
    let graph = r#"Graph(
        resources: { "a": Buffer(items: 8) },
        let: { "double": "2 * i" },
        passes: [
            Repeat(times: 3, index: "i", passes: [
                Compute(name: "turn", shader: "constant.wgsl", each: Item("a"), bind: {"dst": "a", "n": "double + 1"}),
            ]),
        ],
        outputs: ["a"],
    )"#;
    let plan = Test::new(graph).plan();
    assert_eq!(paths(&plan), ["turn[2]"], "each iteration overwrites the one before");
    assert_eq!(shader(&plan, 0).constants, [("n".to_owned(), 5.0)]);
}

#[test]
fn what_a_part_makes_of_a_counter_is_worked_out_in_each_iteration() {
    let part = r#"Graph(
        params: { "n": Int(default: 0, min: 0, max: 100) },
        let: { "square": "n * n" },
        passes: [],
        outputs: { "squared": "square" },
    )"#;
    let graph = r#"Graph(
        resources: { "a": Buffer(items: 8), "b": Buffer(items: "steady") },
        let: { "steady": "2 * 4", "sum": "part.squared + steady" },
        passes: [
            Repeat(times: 4, index: "i", passes: [
                Use(graph: "part.ron", name: "part", params: {"n": "i + 1"}),
                Compute(name: "turn", shader: "constant.wgsl", each: Item("a"), bind: {"dst": "a", "n": "sum"}),
            ]),
            Compute(name: "copy", shader: "copy.wgsl", each: Item("b"), bind: {"src": "a", "dst": "b"}),
        ],
        outputs: ["b"],
    )"#;
    let plan = Test::new(graph).with("graphs/part.ron", part).plan();
    assert_eq!(paths(&plan), ["turn[3]", "copy"]);
    assert_eq!(shader(&plan, 0).constants, [("n".to_owned(), 24.0)], "4 * 4 + 8");
}

/// Blocks of scalars are put together once for all iterations only if no counter is in them.
#[test]
fn blocks_see_each_value_of_a_counter() {
    let more = "struct Values { direct: u32, derived: u32, steady: u32 } var<uniform> values: Values;
        var<storage, read_write> dst: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
            dst[i.x] += values.direct + values.derived + values.steady; }";
    let part = r#"Graph(
        inputs: { "dst": Buffer },
        params: { "direct": Int(default: 0, min: 0, max: 100), "steady": Int(default: 7, min: 0, max: 100) },
        let: { "derived": "direct * direct" },
        passes: [ Compute(name: "more", shader: "more.wgsl", each: Item("dst")) ],
        outputs: ["dst"],
    )"#;
    let graph = r#"Graph(
        params: { "direct": Int(default: 1, min: 0, max: 100), "steady": Int(default: 7, min: 0, max: 100) },
        resources: { "dst": Buffer(items: 8) },
        let: { "derived": "10 + i" },
        passes: [
            Clear(of: "dst"),
            Repeat(times: 3, index: "i", passes: [
                Compute(name: "here", shader: "more.wgsl", each: Item("dst")),
                Use(graph: "part.ron", name: "part", params: {"direct": "i + 1"}),
                Repeat(times: 2, passes: [
                    Use(graph: "part.ron", name: "same", params: {"direct": "4"}),
                ]),
            ]),
        ],
        outputs: ["dst"],
    )"#;
    let plan = Test::new(graph).with("graphs/part.ron", part).with("shaders/more.wgsl", more).plan();
    let of = |name: &str| -> Vec<String> {
        let named = (0..plan.passes.len()).filter(|p| plan.passes[*p].path.starts_with(name));
        let block = |p| match shader(&plan, p).bindings.iter().find(|b| *b.name == *"values").unwrap().bound {
            Bound::Uniform { block } => &plan.uniforms[block].members,
            ref other => panic!("{other:?}"),
        };
        let told = |value: &UniformValue| match value {
            UniformValue::Known(value) => value.to_string(),
            UniformValue::Live(_) => "live".to_owned(),
        };
        named.map(|p| block(p).iter().map(|m| told(&m.value)).collect::<Vec<_>>().join(" ")).collect()
    };
    assert_eq!(of("here"), ["1 10 7", "1 11 7", "1 12 7"]);
    assert_eq!(of("part/"), ["1 1 7", "2 4 7", "3 9 7"]);
    assert_eq!(of("same/"), ["4 16 7"; 6]);
}

#[test]
fn loops_in_loops_are_numbered_from_outside_in() {
    let passes = r#"
        Clear(name: "zero", of: "a"),
        Repeat(times: 2, passes: [ Repeat(times: 2, passes: [
            Compute(name: "more", shader: "add.wgsl", each: Item("a"), bind: {"dst": "a"}),
        ]) ]),"#;
    let plan = Test::of(r#""a": Buffer(items: 8)"#, passes, r#""a""#).plan();
    assert_eq!(paths(&plan), ["zero", "more[0][0]", "more[0][1]", "more[1][0]", "more[1][1]"]);
}

/// State that swaps `times` in a step.
fn ringed(times: usize) -> Plan {
    let graph = r#"Graph(
        state: { "old": Buffer(items: 8), "next": Buffer(items: 8) },
        resources: { "out": Buffer(items: 8) },
        passes: [
            Steps(name: "sim", rate: 120, passes: [
                Repeat(times: TIMES, swap: [("old", "next")], passes: [
                    Compute(name: "step", shader: "step.wgsl", each: Item("next"), bind: {"src": "old", "dst": "next"}),
                ]),
            ]),
            Copy(name: "show", from: "old", to: "out"),
        ],
        outputs: ["out"],
    )"#;
    Test::new(&graph.replace("TIMES", &times.to_string())).plan()
}

#[test]
fn state_that_swaps_is_a_ring_that_turns_after_each_step() {
    for times in 1..4 {
        let plan = ringed(times);
        assert_eq!(plan.rings.len(), 1);
        let ring = &plan.rings[0];
        assert_eq!(ring.objects, [object(&plan, "old"), object(&plan, "next")]);
        assert_eq!((ring.turn, ring.steps), (times % 2, 0), "{times} swaps");
        assert_eq!(bound(&plan, pass(&plan, "step[0]"), "src"), ObjectRef::Ring { ring: 0, index: 0 });
        assert_eq!(bound(&plan, pass(&plan, "step[0]"), "dst"), ObjectRef::Ring { ring: 0, index: 1 });
        // After the steps the first name has the newest: the ring has turned, so it is at home.
        assert_eq!(plan.passes[pass(&plan, "show")].accesses[0].object, ObjectRef::Ring { ring: 0, index: 0 });
        assert_eq!(plan.steps[0].path, "sim");
        assert_eq!(plan.steps[0].rate, Some(120.0));
        assert_eq!(plan.steps[0].passes, 0..times);
        assert_eq!(plan.steps[0].state, ring.objects);
        assert_eq!(plan.passes.iter().filter(|p| p.steps == Some(0)).count(), times);
    }
}

#[test]
fn the_key_of_steps_follows_the_state_that_they_have() {
    let key = |times| ringed(times).steps[0].key;
    assert_eq!(key(1), key(2), "code may change and the state goes on");
    let graph = |items: usize| {
        Test::new(&format!(
            r#"Graph(state: {{ "s": Buffer(items: {items}) }}, resources: {{ "out": Buffer(items: {items}) }}, passes: [
                Steps(rate: PerFrame, passes: [ Compute(name: "step", shader: "add.wgsl", each: Item("s"), bind: {{"dst": "s"}}) ]),
                Copy(name: "show", from: "s", to: "out"),
            ], outputs: ["out"])"#
        ))
        .plan()
    };
    assert_ne!(graph(8).steps[0].key, graph(9).steps[0].key);
    assert_eq!(graph(8).steps[0].rate, None);
}
