//! Random graphs under random changes.

use std::collections::BTreeSet;

use meniscus::engine::{Engine, Policy, Report};
use meniscus::plan::changes::{Cause, Reason};
use meniscus::plan::model::{ObjectId, Origin, Plan, Slot};

use crate::generate::{Generated, grow};
use crate::planning::objects;
use crate::poison;
use crate::world::{Alter, Numbers, World};

/// `MENISCUS_STEPS=10000` in the environment looks further, `MENISCUS_SEED=62` begins with that graph.
const STEPS: u32 = 300;
/// Changes to a graph.
const TO_A_GRAPH: u32 = 25;

fn graph(seed: u64) -> Generated {
    let mut numbers = Numbers(seed);
    let count = 40 + numbers.below(80);
    grow(&(0..count).map(|_| numbers.next()).collect::<Vec<_>>())
}

fn asked(name: &str, otherwise: u32) -> u32 {
    std::env::var(name).ok().and_then(|count| count.parse().ok()).unwrap_or(otherwise)
}

/// What was done before a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Change {
    Nothing,
    Time,
    Eye,
    Picture,
    Given,
    Times,
    Fancy,
    Size,
    Again,
    Steps,
    Only,
    Fail,
    Policy,
    Poison,
    Reset,
    Roots,
    Edit,
}

const CHANGES: [Change; 17] = [
    Change::Nothing,
    Change::Time,
    Change::Eye,
    Change::Picture,
    Change::Given,
    Change::Times,
    Change::Fancy,
    Change::Size,
    Change::Again,
    Change::Steps,
    Change::Only,
    Change::Fail,
    Change::Policy,
    Change::Poison,
    Change::Reset,
    Change::Roots,
    Change::Edit,
];

fn apply(world: &mut World<'_>, numbers: &mut Numbers) -> Change {
    let change = CHANGES[numbers.below(CHANGES.len() as u32) as usize];
    world.now.steps = 0;
    match change {
        Change::Nothing => {}
        Change::Time => world.now.time += f64::from(1 + numbers.below(3)),
        Change::Eye => world.now.eye[numbers.below(3) as usize] += 1.0 / 64.0,
        Change::Picture => {
            world.now.picture = numbers.next() as u8;
            world.upload_picture();
        }
        Change::Given => {
            world.now.given = numbers.below(1000);
            world.upload_given();
        }
        Change::Times => world.graph.times = (world.graph.times + 1 + i64::from(numbers.below(3))) % 4,
        Change::Fancy => world.graph.fancy = !world.graph.fancy,
        Change::Size => world.now.viewport = [4 + numbers.below(30), 4 + numbers.below(30)],
        Change::Steps => world.now.steps = 1 + numbers.below(3),
        Change::Only => {
            world.now.time += 1.0;
            let passes = world.skips().plan().passes.len();
            let only: Vec<bool> = (0..passes).map(|_| numbers.below(2) == 0).collect();
            world.run_only(&only);
        }
        Change::Fail => world.fail(),
        Change::Policy => {
            world.policy = Policy::ALL[(world.policy as usize + 1) % 3];
        }
        Change::Poison => world.each(&|engine, runner| runner.poison(engine).unwrap()),
        Change::Reset => world.each(&|engine, runner| runner.reset_state(engine).unwrap()),
        Change::Roots if world.graph.roots.is_empty() => world.graph.roots.clone_from(&world.graph.written),
        Change::Roots => world.graph.roots.clear(),
        Change::Edit => _ = world.graph.edit(|n| numbers.below(n)),
        Change::Again => {}
    }
    let plans =
        [Change::Times, Change::Fancy, Change::Size, Change::Again, Change::Policy, Change::Roots, Change::Edit];
    if plans.contains(&change) {
        let known: BTreeSet<String> = inputs(world);
        world.prepare();
        if inputs(world) != known {
            world.upload();
        }
    }
    change
}

/// Inputs that passes read, which is to say that have memory.
fn inputs(world: &mut World<'_>) -> BTreeSet<String> {
    let objects = &world.skips().plan().objects;
    objects.iter().filter(|o| matches!(o.origin, Origin::Input(_))).map(|o| o.path.clone()).collect()
}

/// Drives a graph through changes; gives what went wrong first.
fn drive(engine: &mut Engine, seed: u64, steps: u32, alter: Alter, look: Look) -> Result<u32, String> {
    let mut world = World::new(engine, graph(seed), alter);
    let mut numbers = Numbers(seed ^ 0x5eed);
    let mut done = Vec::new();
    let mut skipped = 0;
    for _ in 0..steps {
        if !done.is_empty() {
            done.push(apply(&mut world, &mut numbers));
        } else {
            done.push(Change::Nothing);
        }
        let [report, full] = world.frame();
        // A plan that is altered may have passes that fill memory with NaN.
        skipped += full.passes.len().saturating_sub(report.passes.len()) as u32;
        let differences = world.differences();
        if !differences.is_empty() {
            return Err(format!("seed {seed}, after {done:?}: {differences:?}\n{report:#?}\n{}", world.graph.graph));
        }
        let units = look == Look::All && done.len() > 1 && world.policy == Policy::Keep;
        let told = counts_equal(&report, &full)
            .and_then(|()| if units { expected(world.full().plan(), done[done.len() - 1], &report) } else { Ok(()) });
        told.map_err(|fault| format!("seed {seed}, after {done:?}: {fault}\n{}", world.graph.graph))?;
    }
    Ok(skipped)
}

/// What is compared.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Look {
    /// Pictures alone.
    Pictures,
    /// Also which units ran.
    All,
}

fn counts_equal(skips: &Report, full: &Report) -> Result<(), String> {
    let outside = |report: &Report| {
        report.counts.iter().filter(|c| !c.in_steps).map(|c| (c.path.clone(), c.raw)).collect::<Vec<_>>()
    };
    let (skips, full) = (outside(skips), outside(full));
    if skips == full { Ok(()) } else { Err(format!("the counts are {skips:?} and not {full:?}")) }
}

/// Exactly the units run that have what changed among their causes.
fn expected(plan: &Plan, change: Change, report: &Report) -> Result<(), String> {
    for (u, unit) in report.units.iter().enumerate() {
        let causes = &plan.units[u].causes;
        let name = |name: &str| Some(Reason::Cause(Cause::Live(name.into())));
        let input = |name: &str| Some(Reason::Cause(Cause::Input(name.into())));
        let (is_among, why) = match change {
            Change::Nothing | Change::Again => (false, None),
            Change::Time => (causes.live.contains("time"), name("time")),
            Change::Eye => (causes.live.contains("camera.position"), None),
            Change::Picture => (causes.inputs.contains("picture"), input("picture")),
            Change::Given => (causes.inputs.contains("given"), input("given")),
            Change::Times if causes.params.contains("times") => {
                (true, Some(Reason::Cause(Cause::Param("times".into()))))
            }
            _ => continue,
        };
        let of_steps = plan.units[u].passes.iter().all(|p| plan.passes[*p].steps.is_some());
        let is_right = if causes.live.contains("step") && !of_steps {
            // What a step touches runs once more after it.
            unit.ran || !is_among
        } else {
            unit.ran == (is_among && !of_steps)
        };
        let says = !unit.ran || why.is_none_or(|why| causes.live.contains("step") || unit.why.contains(&why));
        if !is_right || !says || unit.ran == unit.why.is_empty() {
            return Err(format!("{change:?}: unit {u} {:?} ran: {} for {:?}", plan.units[u], unit.ran, unit.why));
        }
    }
    Ok(())
}

pub fn pictures_equal_those_of_full_runs(engine: &mut Engine) {
    let mut skipped = 0;
    let (steps, first) = (asked("MENISCUS_STEPS", STEPS), asked("MENISCUS_SEED", 0));
    for seed in first..first + steps.div_ceil(TO_A_GRAPH) {
        let driven = drive(engine, u64::from(seed), TO_A_GRAPH, |_| (), Look::All);
        skipped += driven.unwrap_or_else(|fault| panic!("{fault}"));
    }
    println!("{steps} changes, {skipped} passes skipped");
    assert!(skipped > steps, "hardly anything was skipped");
}

/// The alteration must be caught for one of the first graphs.
fn caught(engine: &mut Engine, what: &str, alter: Alter, look: Look) {
    let caught = (0..12).any(|seed| drive(engine, seed, TO_A_GRAPH, alter, look).is_err());
    assert!(caught, "{what} was not caught");
}

pub fn a_cause_that_was_dropped_is_caught(engine: &mut Engine) {
    let drops: [(&str, Alter); 4] = [
        ("a unit without the time", |plan| plan.units.iter_mut().for_each(|u| _ = u.causes.live.remove("time"))),
        ("a unit without the camera", |plan| {
            plan.units.iter_mut().for_each(|u| _ = u.causes.live.remove("camera.position"));
        }),
        ("a unit without the picture", |plan| {
            plan.units.iter_mut().for_each(|u| _ = u.causes.inputs.remove("picture"));
        }),
        ("a unit without the buffer", |plan| plan.units.iter_mut().for_each(|u| _ = u.causes.inputs.remove("given"))),
    ];
    for (what, alter) in drops {
        caught(engine, what, alter, Look::Pictures);
    }
    // A parameter changes the pass that it is written into, which is seen too: only the reason tells.
    let without: Alter = |plan| plan.units.iter_mut().for_each(|u| _ = u.causes.params.remove("times"));
    caught(engine, "a unit without a parameter", without, Look::All);
}

pub fn a_reader_that_was_forgotten_is_caught(engine: &mut Engine) {
    caught(
        engine,
        "a unit whose readers are not told",
        |plan| {
            plan.units.iter_mut().for_each(|unit| unit.readers.clear());
        },
        Look::Pictures,
    );
}

pub fn memory_shared_by_what_lives_together_is_caught(engine: &mut Engine) {
    let looks = Look::Pictures;
    caught(
        engine,
        "memory of two that live at once",
        |plan| {
            let both: Vec<ObjectId> =
                ["items_a", "items_b"].iter().flat_map(|name| objects(plan, plan.names[*name])).collect();
            plan.memory.keep.retain(|slot| !slot.objects.iter().any(|id| both.contains(id)));
            plan.memory.keep.push(Slot { objects: both, bytes: 400 });
        },
        looks,
    );
}

pub fn shared_memory_holds_nothing_that_is_missed(engine: &mut Engine) {
    for seed in 0..8 {
        let driven = drive(engine, seed, TO_A_GRAPH, poison::shared, Look::Pictures);
        driven.unwrap_or_else(|fault| panic!("{fault}"));
    }
}
