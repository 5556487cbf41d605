//! Properties of the plans of random graphs.

use std::collections::BTreeSet;

use meniscus::diagnostic::{Style, render_all};
use meniscus::plan::model::{Access, ObjectKind, Origin, PassKind, Plan, Request};
use meniscus::plan::print;
use proptest::prelude::*;
use wgpu_types::{Features, Limits};

use super::memory;
use crate::generate::{Generated, grow};
use crate::planning::objects;

fn request(graph: &Generated, turned: bool) -> Request {
    graph.request(Features::all(), Limits::default(), turned)
}

fn plan(graph: &Generated, request: &Request) -> Plan {
    graph.plan(request).unwrap_or_else(|(found, sources)| {
        panic!("{}\n{}", graph.graph, render_all(&found, &sources, Style::Plain));
    })
}

fn is_made(kind: &PassKind) -> bool {
    matches!(kind, PassKind::Settle { .. } | PassKind::Mips { .. } | PassKind::Arguments { .. })
}

/// The mips and layers of an access.
fn parts(plan: &Plan, kind: &PassKind, access: &Access) -> Vec<(usize, u32, u32)> {
    let mips = match kind {
        // It makes the others.
        PassKind::Mips { .. } => 0..1,
        _ => access.mips.clone(),
    };
    let of = |id: usize| mips.clone().flat_map(move |mip| access.layers.clone().map(move |layer| (id, mip, layer)));
    objects(plan, access.object).into_iter().flat_map(of).collect()
}

/// Every read of what the frame makes has a write before it.
fn reads_are_written(plan: &Plan) {
    let mut written = BTreeSet::new();
    for pass in &plan.passes {
        for access in pass.accesses.iter().filter(|a| a.read) {
            for part in parts(plan, &pass.kind, access) {
                let is_of_frame = plan.objects[part.0].origin == Origin::Frame;
                assert!(!is_of_frame || written.contains(&part), "{} reads {part:?} too early", pass.path);
            }
        }
        for access in pass.accesses.iter().filter(|a| a.write) {
            let all = Access { mips: access.mips.clone(), ..access.clone() };
            let kind = PassKind::Copy { from: whole(access), to: whole(access) };
            written.extend(parts(plan, &kind, &all));
        }
    }
}

fn whole(access: &Access) -> meniscus::plan::model::View {
    meniscus::plan::model::View {
        object: access.object,
        mips: access.mips.clone(),
        layers: access.layers.clone(),
        dimension: meniscus::shader::reflect::TextureDimension::D2,
    }
}

/// Nothing is bound, attached or touched beyond what the object has.
fn accesses_are_inside(plan: &Plan) {
    for access in plan.passes.iter().flat_map(|pass| &pass.accesses) {
        for id in objects(plan, access.object) {
            let (mips, layers) = match &plan.objects[id].kind {
                ObjectKind::Texture(t) => (t.mips, if t.is_3d { 1 } else { t.layers }),
                ObjectKind::Buffer(_) => (1, 1),
            };
            assert!(access.mips.end <= mips && access.layers.end <= layers, "{access:?} of {}", plan.objects[id].path);
            assert!(!access.mips.is_empty() && !access.layers.is_empty(), "{access:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_graphs_have_right_plans(numbers in prop::collection::vec(any::<u32>(), 0..120)) {
        let graph = grow(&numbers);
        let plan = plan(&graph, &request(&graph, false));
        reads_are_written(&plan);
        accesses_are_inside(&plan);
        let declared = plan.passes.iter().filter(|pass| !is_made(&pass.kind)).count();
        let told = declared + plan.culled.len() + plan.order.folded.len();
        prop_assert_eq!(told, graph.passes, "live, culled and folded are all:\n{}", graph.graph);
        memory::hold(&plan);
        memory::compare(&plan);
    }

    #[test]
    fn planning_is_deterministic(numbers in prop::collection::vec(any::<u32>(), 0..60)) {
        let graph = grow(&numbers);
        let once = plan(&graph, &request(&graph, false));
        let again = plan(&graph, &request(&graph, true));
        prop_assert_eq!(print::text(&once), print::text(&again));
        prop_assert_eq!(print::json(&once), print::json(&again));
        prop_assert_eq!(print::dot(&once), print::dot(&again));
        prop_assert_eq!(print::svg(&once), print::svg(&again));
    }
}

#[test]
fn the_same_program_plans_alike_whatever_was_planned_before() {
    use meniscus::diagnostic::Sources;
    use meniscus::plan::instantiate;
    let graph = grow(&(0..80).map(|i: u32| i.wrapping_mul(2_654_435_761) >> 7).collect::<Vec<_>>());
    let loaded = meniscus::program::load(&graph.files(), &mut Sources::new(), "graphs/test.ron", None);
    let program = loaded.program.unwrap();
    let first = print::json(&instantiate(&program, &request(&graph, false)).unwrap());
    let mut other = request(&graph, false);
    other.viewport = [333, 222];
    let between = print::json(&instantiate(&program, &other).unwrap());
    assert_ne!(first, between);
    assert_eq!(first, print::json(&instantiate(&program, &request(&graph, false)).unwrap()));
}

#[test]
fn a_plan_that_reads_too_early_is_caught() {
    let graph = grow(&(0..60).map(|i: u32| i.wrapping_mul(40_503) >> 3).collect::<Vec<_>>());
    let mut broken = plan(&graph, &request(&graph, false));
    reads_are_written(&broken);
    // The last pass that reads something of the frame goes first.
    let of_frame =
        |access: &Access| objects(&broken, access.object).iter().all(|id| broken.objects[*id].origin == Origin::Frame);
    let reader = broken.passes.iter().rposition(|p| p.accesses.iter().any(|a| a.read && of_frame(a))).unwrap();
    let moved = broken.passes.remove(reader);
    broken.passes.insert(0, moved);
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| reads_are_written(&broken)));
    assert!(caught.is_err(), "the planted fault was not caught");
}
