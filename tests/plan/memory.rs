//! Lifetimes, and what shares memory under each policy.

use std::collections::{BTreeMap, BTreeSet};

use meniscus::diagnostic::{Style, render_all};
use meniscus::plan::memory::{bytes, total};
use meniscus::plan::model::{Causes, Cut, InputInfo, MemoryRequest, ObjectId, Origin, Pass, Plan, Policy, Slot, Why};

use crate::planning::{Test, object, objects, pass};

/// Whose content each slot has while a plan runs.
struct Simulation<'a> {
    plan: &'a Plan,
    slot: BTreeMap<ObjectId, usize>,
    holds: BTreeMap<usize, ObjectId>,
    slots: &'a [Slot],
    cuts: &'a [Cut],
    /// Slots that have memory.
    there: BTreeSet<usize>,
    /// The most bytes that had memory at once.
    most: u64,
}

impl<'a> Simulation<'a> {
    fn new(plan: &'a Plan, policy: Policy) -> Self {
        let (slots, cuts) = (plan.memory.slots(policy), plan.memory.cuts(policy));
        let of = |(s, slot): (usize, &Slot)| slot.objects.iter().map(move |id| (*id, s)).collect::<Vec<_>>();
        let slot: BTreeMap<ObjectId, usize> = slots.iter().enumerate().flat_map(of).collect();
        let members: usize = slots.iter().map(|slot| slot.objects.len()).sum();
        assert_eq!(members, slot.len(), "an object has two slots");
        Self { plan, slot, holds: BTreeMap::new(), slots, cuts, there: BTreeSet::new(), most: 0 }
    }

    /// Gives back what the next frame does not begin with, and makes what it does.
    fn begin(&mut self) {
        let late: BTreeSet<usize> = self.cuts.iter().flat_map(|cut| cut.makes.iter().copied()).collect();
        self.holds.retain(|slot, _| !late.contains(slot));
        self.there = (0..self.slots.len()).filter(|slot| !late.contains(slot)).collect();
        self.count();
    }

    fn count(&mut self) {
        self.most = self.most.max(self.there.iter().map(|slot| self.slots[*slot].bytes).sum());
    }

    fn cut(&mut self, before: usize) {
        for cut in self.cuts.iter().filter(|cut| cut.before == before) {
            for slot in &cut.gives {
                assert!(self.there.remove(slot), "memory that is not there is given back");
                self.holds.remove(slot);
            }
            for slot in &cut.makes {
                assert!(self.there.insert(*slot), "memory that is there is made");
            }
            self.count();
        }
    }

    /// Runs the passes that are chosen, `Steps` twice.
    fn frame(&mut self, runs: &dyn Fn(&Pass) -> bool) {
        self.begin();
        let mut at = 0;
        while at < self.plan.passes.len() {
            self.cut(at);
            match self.plan.passes[at].steps {
                Some(steps) => {
                    let range = self.plan.steps[steps].passes.clone();
                    for _ in 0..2 {
                        range.clone().for_each(|p| self.pass(p, runs));
                    }
                    at = range.end;
                }
                None => {
                    self.pass(at, runs);
                    at += 1;
                }
            }
        }
        // What somebody looks at is there afterwards.
        for output in &self.plan.outputs {
            for id in objects(self.plan, output.object) {
                if let Some(slot) = self.slot.get(&id) {
                    assert_eq!(self.holds.get(slot), Some(&id), "the output {} was overwritten", output.name);
                }
            }
        }
    }

    fn pass(&mut self, p: usize, runs: &dyn Fn(&Pass) -> bool) {
        let pass = &self.plan.passes[p];
        if !runs(pass) {
            return;
        }
        for (read, access) in [true, false].into_iter().flat_map(|read| pass.accesses.iter().map(move |a| (read, a))) {
            for id in objects(self.plan, access.object) {
                let Some(slot) = self.slot.get(&id) else {
                    assert_ne!(
                        self.plan.objects[id].origin,
                        Origin::Frame,
                        "{} has no memory",
                        self.plan.objects[id].path
                    );
                    continue;
                };
                assert!(
                    self.there.contains(slot),
                    "{} uses {}, which has no memory",
                    pass.path,
                    self.plan.objects[id].path
                );
                if read && access.read {
                    let found = self.holds.get(slot).map(|id| &self.plan.objects[*id].path);
                    assert_eq!(found, Some(&self.plan.objects[id].path), "{} reads what another wrote", pass.path);
                }
                if !read && access.write {
                    self.holds.insert(*slot, id);
                }
            }
        }
    }
}

/// Everything that units depend on, one at a time.
fn single_causes(plan: &Plan) -> Vec<Causes> {
    let mut all = Vec::new();
    let mut names: [BTreeSet<String>; 3] = Default::default();
    for unit in &plan.units {
        names[0].extend(unit.causes.inputs.iter().cloned());
        names[1].extend(unit.causes.live.iter().cloned());
        names[2].extend(unit.causes.params.iter().cloned());
    }
    all.extend(names[0].iter().map(|n| Causes { inputs: [n.clone()].into(), ..Causes::default() }));
    all.extend(names[1].iter().map(|n| Causes { live: [n.clone()].into(), ..Causes::default() }));
    all.extend(names[2].iter().map(|n| Causes { params: [n.clone()].into(), ..Causes::default() }));
    all.push(Causes { viewport: true, ..Causes::default() });
    all
}

fn meets(a: &Causes, b: &Causes) -> bool {
    !a.inputs.is_disjoint(&b.inputs)
        || !a.live.is_disjoint(&b.live)
        || !a.params.is_disjoint(&b.params)
        || (a.viewport && b.viewport)
}

/// Runs the plan on shared memory and asserts that no pass finds another's content, or none: under
/// the policies that share and cut with every unit each frame, under the keeping one also with the units alone
/// that one cause makes run.
pub fn hold(plan: &Plan) {
    for policy in [Policy::Share, Policy::Smallest] {
        let mut simulation = Simulation::new(plan, policy);
        simulation.frame(&|_| true);
        simulation.frame(&|_| true);
        assert_eq!(simulation.most, plan.memory.of_frame(policy), "{policy:?} holds what the plan says");
    }
    let mut keep = Simulation::new(plan, Policy::Keep);
    keep.frame(&|_| true);
    for cause in single_causes(plan) {
        keep.frame(&|pass| meets(&plan.units[pass.unit].causes, &cause));
    }
    for output in &plan.outputs {
        for id in objects(plan, output.object) {
            let alone =
                |slots: &[Slot]| slots.iter().all(|slot| !slot.objects.contains(&id) || slot.objects.len() == 1);
            assert!(alone(&plan.memory.keep), "the output {} shares", output.name);
        }
    }
}

/// No plan can hold less than what is live at once, and sharing saves.
pub fn compare(plan: &Plan) {
    let memory = &plan.memory;
    let [keep, share, smallest] = Policy::ALL.map(|policy| memory.of_frame(policy));
    assert!(memory.lower_bound <= memory.alike_bound, "{} > {}", memory.lower_bound, memory.alike_bound);
    assert!(memory.alike_bound <= share, "{} > {share}", memory.alike_bound);
    assert!(memory.lower_bound <= smallest, "{} > {smallest}", memory.lower_bound);
    assert!(smallest <= share, "{smallest} > {share}");
    assert!(share <= keep, "{share} > {keep}");
    assert!(keep <= memory.unshared, "{keep} > {}", memory.unshared);
}

/// a -> b -> c -> d -> e, 400 bytes each; nothing depends on anything.
fn chain() -> Plan {
    let resources: String = ["a", "b", "c", "d", "e"].map(|n| format!(r#""{n}": Buffer(items: 100),"#)).concat();
    let mut passes = r#"Compute(name: "a", shader: "fill.wgsl", each: Item("a"), bind: {"dst": "a"}),"#.to_owned();
    for (src, dst) in [("a", "b"), ("b", "c"), ("c", "d"), ("d", "e")] {
        passes += &format!(
            r#"Compute(name: "{dst}", shader: "copy.wgsl", each: Item("{dst}"), bind: {{"src": "{src}", "dst": "{dst}"}}),"#
        );
    }
    Test::of(&resources, &passes, r#""e""#).plan()
}

#[test]
fn a_chain_needs_two_pieces_and_its_output() {
    let plan = chain();
    let lifetimes: Vec<_> = ["a", "b", "c", "d", "e"].map(|n| plan.objects[object(&plan, n)].lifetime.unwrap()).into();
    assert_eq!(lifetimes, [(0, 1), (1, 2), (2, 3), (3, 4), (4, 4)]);
    hold(&plan);
    compare(&plan);
    let memory = &plan.memory;
    assert_eq!((memory.unshared, total(&memory.keep), total(&memory.share)), (2000, 1200, 800));
    assert_eq!((memory.lower_bound, memory.alike_bound), (800, 800));
    let id = |name| object(&plan, name);
    let groups: Vec<_> = memory.keep.iter().map(|slot| slot.objects.clone()).collect();
    assert_eq!(groups, [vec![id("a"), id("c")], vec![id("b"), id("d")], vec![id("e")]]);
}

#[test]
fn overlapping_lives_are_caught() {
    let mut plan = chain();
    let both = vec![object(&plan, "a"), object(&plan, "b")];
    plan.memory.share.retain(|slot| !slot.objects.iter().any(|id| both.contains(id)));
    plan.memory.share.push(Slot { objects: both, bytes: 400 });
    let caught = std::panic::catch_unwind(|| hold(&plan));
    assert!(caught.is_err(), "the planted fault was not caught");
}

#[test]
fn keeping_shares_only_between_equal_causes() {
    // `still` and `kept` never change; `gained` and all behind it do with a parameter.
    let graph = r#"Graph(
        params: { "gain": Float(default: 1.0, min: 0.0, max: 9.0) },
        resources: { "still": Buffer(items: 64), "kept": Buffer(items: 64), "gained": Buffer(items: 64),
                     "m": Buffer(items: 64), "p": Buffer(items: 64), "q": Buffer(items: 64), "o": Buffer(items: 64) },
        passes: [
            Clear(name: "still", of: "still"),
            Copy(name: "kept", from: "still", to: "kept"),
            Compute(name: "gain", shader: "gain.wgsl", each: Item("gained"), bind: {"dst": "gained"}),
            Compute(name: "m", shader: "mix.wgsl", each: Item("m"), bind: {"left": "kept", "right": "gained", "dst": "m"}),
            Compute(name: "p", shader: "mix.wgsl", each: Item("p"), bind: {"left": "m", "right": "m", "dst": "p"}),
            Compute(name: "q", shader: "mix.wgsl", each: Item("q"), bind: {"left": "p", "right": "m", "dst": "q"}),
            Compute(name: "o", shader: "mix.wgsl", each: Item("o"), bind: {"left": "p", "right": "q", "dst": "o"}),
        ],
        outputs: ["o"],
    )"#;
    let plan = Test::new(graph).plan();
    hold(&plan);
    compare(&plan);
    let id = |name| object(&plan, name);
    let together = |slots: &[Slot], a, b| slots.iter().any(|s| s.objects.contains(&a) && s.objects.contains(&b));
    // `kept` is read by a unit that runs more often than the one that writes it.
    assert!(plan.memory.keep.iter().any(|slot| slot.objects == [id("kept")]));
    assert!(together(&plan.memory.keep, id("gained"), id("p")));
    assert!(together(&plan.memory.share, id("kept"), id("q")));
    assert_eq!((total(&plan.memory.keep), total(&plan.memory.share)), (5 * 256, 3 * 256));
}

#[test]
fn what_lives_into_steps_lives_to_their_end() {
    let graph = r#"Graph(
        state: { "s": Buffer(items: 64) },
        resources: { "wall": Buffer(items: 64), "a": Buffer(items: 64), "b": Buffer(items: 64), "out": Buffer(items: 64) },
        passes: [
            Clear(name: "wall", of: "wall"),
            Steps(rate: 60, passes: [
                Copy(name: "first", from: "wall", to: "a"),
                Copy(name: "second", from: "a", to: "b"),
                Copy(name: "third", from: "b", to: "s"),
            ]),
            Copy(name: "show", from: "s", to: "out"),
        ],
        outputs: ["out"],
    )"#;
    let plan = Test::new(graph).plan();
    // The next step reads the wall again.
    assert_eq!(plan.objects[object(&plan, "wall")].lifetime, Some((0, 3)));
    assert_eq!(plan.objects[object(&plan, "a")].lifetime, Some((1, 2)));
    hold(&plan);
    compare(&plan);
    let wall = object(&plan, "wall");
    for slots in [&plan.memory.keep, &plan.memory.share] {
        let (a, b) = (object(&plan, "a"), object(&plan, "b"));
        let with_it = slots.iter().find(|slot| slot.objects.contains(&wall)).unwrap();
        assert!(!with_it.objects.contains(&a) && !with_it.objects.contains(&b), "{slots:?}");
        assert!(slots.iter().all(|slot| !slot.objects.contains(&object(&plan, "s"))), "state is not of the frame");
    }
}

#[test]
fn what_steps_make_for_others_has_memory_of_its_own_while_things_are_kept() {
    let graph = r#"Graph(
        state: { "s": Buffer(items: 64) },
        resources: { "sum": Buffer(items: 64), "late": Buffer(items: 64), "out": Buffer(items: 64) },
        passes: [
            Clear(name: "zero", of: "sum"),
            Steps(rate: 60, passes: [
                Compute(name: "step", shader: "add.wgsl", each: Item("s"), bind: {"dst": "s"}),
                Copy(name: "sum", from: "s", to: "sum"),
            ]),
            Copy(name: "show", from: "sum", to: "s_out"),
            Copy(name: "late", from: "s_out", to: "late"),
            Copy(name: "out", from: "late", to: "out"),
        ],
        outputs: ["out"],
    )"#;
    let graph = graph.replace(r#""late": Buffer"#, r#""s_out": Buffer(items: 64), "late": Buffer"#);
    let plan = Test::new(&graph).plan();
    hold(&plan);
    compare(&plan);
    let sum = object(&plan, "sum");
    assert!(plan.memory.keep.iter().any(|slot| slot.objects == [sum]), "{:?}", plan.memory.keep);
    assert!(plan.memory.share.iter().any(|slot| slot.objects == [sum, object(&plan, "late")]));
}

#[test]
fn textures_share_only_with_their_like_and_a_slot_is_as_large_as_its_largest() {
    let resources = r#""a": Texture(format: Rgba16Float, size: (8, 8)), "b": Texture(format: Rgba8Unorm, size: (8, 8)),
        "c": Texture(format: Rgba16Float, size: (8, 8)), "d": Texture(format: Rgba16Float, size: (8, 8)),
        "small": Buffer(items: 10), "middle": Buffer(items: 1), "large": Buffer(items: 1000), "last": Buffer(items: 2)"#;
    let filter = |dst: &str, src: &str| {
        format!(r#"Fullscreen(name: "{dst}", shader: "filter.wgsl", color: ["{dst}"], bind: {{"src": "{src}"}}),"#)
    };
    let copy = |dst: &str, src: &str| {
        format!(
            r#"Compute(name: "{dst}", shader: "copy.wgsl", each: Item("{dst}"), bind: {{"src": "{src}", "dst": "{dst}"}}),"#
        )
    };
    let passes = [
        r#"Fullscreen(name: "a", shader: "paint.wgsl", color: ["a"]),"#.to_owned(),
        filter("b", "a"),
        filter("c", "b"),
        filter("d", "c"),
        r#"Compute(name: "small", shader: "fill.wgsl", each: Item("small"), bind: {"dst": "small"}),"#.to_owned(),
        copy("middle", "small"),
        copy("large", "middle"),
        copy("last", "large"),
    ];
    let plan = Test::of(resources, &passes.concat(), r#""d""#).root("last").plan();
    hold(&plan);
    compare(&plan);
    let id = |name| object(&plan, name);
    assert!(plan.memory.share.contains(&Slot { objects: vec![id("a"), id("c")], bytes: 8 * 8 * 8 }));
    assert!(plan.memory.share.contains(&Slot { objects: vec![id("b")], bytes: 8 * 8 * 4 }));
    assert!(plan.memory.share.contains(&Slot { objects: vec![id("small"), id("large")], bytes: 4000 }));
    assert_eq!(plan.memory.unshared, plan.objects.iter().map(|o| bytes(&o.kind)).sum::<u64>());
    assert_eq!(plan.objects[id("last")].lifetime, Some((pass(&plan, "last"), pass(&plan, "last"))));
}

/// Two pairs of textures whose lives do not meet, one after the other for causes of its own.
fn two_times(request: MemoryRequest) -> Result<Plan, String> {
    let graph = r#"Graph(
        inputs: { "camera": Camera, "given": Buffer },
        resources: { "a": Buffer(items: 1000), "b": Buffer(items: 1000), "c": Buffer(items: 1000), "out": Buffer(items: 1000) },
        passes: [
            Compute(name: "a", shader: "copy.wgsl", each: Item("a"), bind: {"src": "given", "dst": "a"}),
            Copy(name: "b", from: "a", to: "b"),
            Compute(name: "c", shader: "eye.wgsl", each: Item("c"), bind: {"dst": "c"}),
            Compute(name: "out", shader: "mix.wgsl", each: Item("out"), bind: {"left": "b", "right": "c", "dst": "out"}),
        ],
        outputs: ["out"],
    )"#;
    let mut test = Test::new(graph)
        .input("camera", InputInfo::Camera)
        .input("given", InputInfo::Buffer { items: 1000, stride: 4 });
    test.request.memory = request;
    test.try_plan().map_err(|(found, sources)| render_all(&found, &sources, Style::Plain))
}

#[test]
fn the_policy_goes_by_what_changes_and_by_the_budget() {
    let policy = |request: MemoryRequest| two_times(request).map(|plan| (plan.memory.policy, plan.memory.why));
    assert_eq!(policy(MemoryRequest::default()), Ok((Policy::Keep, Why::Still)));
    let moving = |name: &str| MemoryRequest { moving: [name.to_owned()].into(), ..MemoryRequest::default() };
    assert_eq!(policy(moving("given")), Ok((Policy::Share, Why::Moving { passes: 3, of: 4 })));
    assert_eq!(policy(moving("nothing")), Ok((Policy::Keep, Why::Moving { passes: 0, of: 4 })));
    let asked = MemoryRequest { policy: Some(Policy::Keep), ..moving("given") };
    assert_eq!(policy(asked), Ok((Policy::Keep, Why::Asked)));
    // Keeping holds 16,000 bytes of the frame and 4,000 of the input.
    let within = |budget| MemoryRequest { budget: Some(budget), ..MemoryRequest::default() };
    assert_eq!(policy(within(20_000)), Ok((Policy::Keep, Why::Still)));
    assert_eq!(policy(within(19_999)), Ok((Policy::Share, Why::Budget { keeping: 20_000 })));
    assert_eq!(policy(within(16_000)), Ok((Policy::Share, Why::Budget { keeping: 20_000 })));
    assert!(two_times(within(15_999)).unwrap_err().contains("memory-budget"));
    assert!(two_times(MemoryRequest { elsewhere: 1, ..within(16_000) }).is_err(), "what others take counts");
}
