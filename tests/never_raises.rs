//! What instantiates never raises an error of wgpu's: random graphs, planned and run on the
//! device, under both policies of memory, with some steps, many and none.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/generate.rs"]
mod generate;
#[path = "engine/harness.rs"]
mod harness;

use std::collections::BTreeSet;
use std::process::ExitCode;

use generate::{Generated, grow};
use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::engine::{Engine, Frame, Policy, StepInfo};
use meniscus::format::TextureFormat;
use meniscus::graph::value::Value;
use meniscus::plan::model::{Access, Bound, ObjectKind, ObjectRef, Pass, PassKind, Plan};
use meniscus::plan::{instantiate, instantiate_in_program_order};
use wgpu_types::{BufferUsages, TextureUsages};

/// `MENISCUS_GRAPHS=5000` in the environment looks further.
const GRAPHS: u64 = 150;

fn main() -> ExitCode {
    harness::run(cases![
        random_graphs_raise_no_error,
        random_graphs_come_out_the_same_in_both_orders,
        a_format_that_was_changed_is_caught,
        a_usage_that_is_missing_is_caught,
        a_view_beyond_its_texture_is_caught,
        a_copy_to_a_layer_that_is_not_there_is_caught,
    ])
}

/// Numbers from a seed, the same on every machine (splitmix64).
fn numbers(seed: u64) -> Vec<u32> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 16) as u32
    };
    let count = 40 + next() % 80;
    (0..count).map(|_| next()).collect()
}

fn plan(engine: &Engine, graph: &Generated) -> Plan {
    let request = graph.request(engine.gpu().features(), engine.gpu().limits(), false);
    graph.plan(&request).unwrap_or_else(|(found, sources)| {
        panic!("{}\n{}", graph.graph, render_all(&found, &sources, Style::Plain));
    })
}

/// Prepares and runs a plan; gives everything that the device refused.
fn run(engine: &mut Engine, plan: Plan) -> Result<(), Diagnostics> {
    let mut runner = engine.prepare(plan, None).map_err(|refused| refused.diagnostics)?;
    for (number, steps) in [1, 3, 0].into_iter().enumerate() {
        let steps = [steps];
        let live = |name: &str, _: Option<&StepInfo>| (name == "camera.position").then(|| Value::vec([0.1, 0.2, 0.3]));
        let frame = Frame { time: 0.25, delta: 0.25, frame: number as u64, steps: &steps, live: &live, only: None };
        runner.run(engine, &frame)?;
        runner.finish(engine)?;
    }
    engine.gpu().check()?;
    Ok(())
}

fn random_graphs_raise_no_error(engine: &mut Engine) {
    let mut kinds = BTreeSet::new();
    let asked = std::env::var("MENISCUS_GRAPHS").ok().and_then(|count| count.parse().ok());
    for seed in 0..asked.unwrap_or(GRAPHS) {
        let graph = grow(&numbers(seed));
        let mut plan = plan(engine, &graph);
        kinds.extend(plan.passes.iter().map(|pass| match &pass.kind {
            PassKind::Compute { .. } => "compute",
            PassKind::Draw(_) => "draw",
            PassKind::Clear { .. } => "clear",
            PassKind::Copy { .. } => "copy",
            PassKind::Mips { .. } => "mips",
            PassKind::Settle { .. } => "settle",
            PassKind::Arguments { .. } => "arguments",
        }));
        plan.memory.policy = Policy::ALL[seed as usize % 3];
        if let Err(found) = run(engine, plan) {
            panic!("seed {seed}: {:?}\n{}", found.iter().map(|d| &d.message).collect::<Vec<_>>(), graph.graph);
        }
    }
    let all = ["arguments", "clear", "compute", "copy", "draw", "mips", "settle"];
    assert_eq!(kinds.into_iter().collect::<Vec<_>>(), all, "the graphs hold every kind of pass");
}

/// The bytes of every output after some frames.
fn outputs(engine: &mut Engine, plan: Plan) -> Vec<Vec<u8>> {
    let mut runner = engine.prepare(plan, None).unwrap_or_else(|refused| panic!("{:?}", refused.diagnostics));
    for (number, steps) in [1, 3, 0].into_iter().enumerate() {
        let steps = [steps];
        let live = |name: &str, _: Option<&StepInfo>| (name == "camera.position").then(|| Value::vec([0.1, 0.2, 0.3]));
        let frame = Frame { time: 0.25, delta: 0.25, frame: number as u64, steps: &steps, live: &live, only: None };
        runner.run(engine, &frame).unwrap();
        runner.finish(engine).unwrap();
    }
    let outputs: Vec<ObjectRef> = runner.plan().outputs.iter().map(|output| output.object).collect();
    let read = outputs.into_iter().map(|object| {
        let texture = runner.read_texture(engine, object, 0, None).map(|data| data.bytes);
        texture.or_else(|_| runner.read_buffer(engine, object)).unwrap_or_default()
    });
    read.collect()
}

/// Brought together or as the program has them, passes make the same; two that need each other,
/// swapped, do not.
fn random_graphs_come_out_the_same_in_both_orders(engine: &mut Engine) {
    let (mut moved, mut folded, mut caught) = (0, 0, 0);
    for seed in 0..40 {
        let graph = grow(&numbers(seed));
        let loaded = meniscus::program::load(&graph.files(), &mut Sources::new(), "graphs/test.ron", None);
        let mut request = graph.request(engine.gpu().features(), engine.gpu().limits(), false);
        let program = loaded.program.unwrap();
        request.roots = program.root.outputs.iter().map(|output| output.name.value.clone()).collect();
        let grouped = instantiate(&program, &request).unwrap();
        let plain = instantiate_in_program_order(&program, &request).unwrap();
        if plain.passes.iter().any(|pass| pass.unordered) {
            continue;
        }
        moved += grouped.order.moved.len();
        folded += grouped.order.folded.len();
        let expected = outputs(engine, plain.clone());
        assert!(outputs(engine, grouped) == expected, "seed {seed}\n{}", graph.graph);
        caught += usize::from(swapped(plain).is_some_and(|wrong| outputs(engine, wrong) != expected));
    }
    assert!(moved > 0 && folded > 0, "{moved} moved, {folded} folded: the graphs hold both");
    assert!(caught > 0, "swapping what needs each other shows");
}

/// The plan with a pass in front of the one whose result it reads.
fn swapped(mut plan: Plan) -> Option<Plan> {
    let needs = |pair: &[Pass]| {
        let same = pair[0].steps.is_none() && pair[1].steps.is_none();
        let reads = |a: &Access| pair[1].accesses.iter().any(|b| b.read && b.object == a.object);
        same && pair[0].accesses.iter().any(|a| a.write && reads(a))
    };
    let at = plan.passes.windows(2).rposition(needs)?;
    plan.passes.swap(at, at + 1);
    // In memory of their own, so that it is the order that shows.
    alone(&mut plan);
    Some(plan)
}

/// The first graphs, altered after planning: each alteration that applies must be caught.
fn caught(engine: &mut Engine, what: &str, alter: impl Fn(&mut Plan) -> bool) {
    let mut applied = 0;
    for seed in 0..12 {
        let mut plan = plan(engine, &grow(&numbers(seed)));
        if alter(&mut plan) {
            applied += 1;
            assert!(run(engine, plan).is_err(), "seed {seed}: {what} was not caught");
        }
        if applied == 3 {
            return;
        }
    }
    assert!(applied > 0, "{what}: no graph has something to alter");
}

fn a_format_that_was_changed_is_caught(engine: &mut Engine) {
    caught(engine, "a target of another format", |plan| {
        let target = plan.passes.iter_mut().find_map(|pass| match &mut pass.kind {
            PassKind::Draw(draw) => draw.color.first_mut(),
            _ => None,
        });
        target.is_some_and(|target| {
            target.format = TextureFormat::Rg32Float;
            true
        })
    });
}

fn a_usage_that_is_missing_is_caught(engine: &mut Engine) {
    caught(engine, "a texture that cannot be bound", |plan| {
        let bound = plan.passes.iter().find_map(|pass| match &pass.kind {
            PassKind::Draw(draw) => draw.shader.bindings.iter().find_map(|binding| match &binding.bound {
                Bound::Texture { view, .. } => Some(view.object),
                _ => None,
            }),
            _ => None,
        });
        let Some(ObjectRef::Fixed(id)) = bound else { return false };
        let ObjectKind::Texture(texture) = &mut plan.objects[id].kind else { return false };
        texture.usages.remove(TextureUsages::TEXTURE_BINDING);
        // Others in the same memory would bring it back, and mips that the engine makes need it.
        alone(plan);
        !plan.passes.iter().any(|pass| pass.kind == PassKind::Mips { texture: ObjectRef::Fixed(id) })
    });
    caught(engine, "a buffer that cannot be bound", |plan| {
        // Kernels that clear and settle bring the usage with them.
        let has_kernel = |id: usize| {
            plan.passes.iter().any(|pass| match &pass.kind {
                PassKind::Clear { view, .. } => view.object == ObjectRef::Fixed(id),
                PassKind::Settle { counted, .. } => *counted == ObjectRef::Fixed(id),
                _ => false,
            })
        };
        let computes = plan.passes.iter().filter(|pass| matches!(pass.kind, PassKind::Compute { .. }));
        let id = computes.flat_map(|pass| &pass.accesses).find_map(|access| match access.object {
            ObjectRef::Fixed(id) if matches!(plan.objects[id].kind, ObjectKind::Buffer(_)) => {
                (!has_kernel(id)).then_some(id)
            }
            _ => None,
        });
        let Some(ObjectKind::Buffer(buffer)) = id.map(|id| &mut plan.objects[id].kind) else { return false };
        buffer.usages.remove(BufferUsages::STORAGE);
        // Others in the same memory would bring it back.
        alone(plan);
        true
    });
}

/// Gives each object memory of its own.
fn alone(plan: &mut Plan) {
    for slots in [&mut plan.memory.keep, &mut plan.memory.share, &mut plan.memory.smallest] {
        slots.clear();
    }
    plan.memory.cuts.clear();
}

fn a_view_beyond_its_texture_is_caught(engine: &mut Engine) {
    caught(engine, "a mip that is not there", |plan| {
        let target = plan.passes.iter_mut().find_map(|pass| match &mut pass.kind {
            PassKind::Draw(draw) => draw.color.first_mut(),
            _ => None,
        });
        target.is_some_and(|target| {
            target.view.mips = 9..10;
            true
        })
    });
}

fn a_copy_to_a_layer_that_is_not_there_is_caught(engine: &mut Engine) {
    caught(engine, "a layer that is not there", |plan| {
        let to = plan.passes.iter_mut().find_map(|pass| match &mut pass.kind {
            PassKind::Copy { to, .. } if !to.layers.is_empty() => Some(to),
            _ => None,
        });
        let Some(to) = to else { return false };
        let ObjectRef::Fixed(id) = to.object else { return false };
        to.layers = 7..8;
        matches!(plan.objects[id].kind, ObjectKind::Texture(_))
    });
}
