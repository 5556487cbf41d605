//! Passes that nothing needs are left out, and said.

use std::collections::BTreeSet;

use super::flow::subresources;
use super::lower::Lowering;
use super::model::{Culled, ObjectId, Origin};

/// Keeps the passes that the roots need; gives back those that were left out.
pub(super) fn cull(lowering: &mut Lowering<'_>, roots: &[ObjectId]) -> Vec<Culled> {
    let mut carried = Carried { state: Vec::new(), steps: vec![Vec::new(); lowering.steps.len()] };
    let live = loop {
        let (live, read) = live_passes(lowering, roots, &carried);
        if read == carried {
            break live;
        }
        carried = read;
    };
    let mut culled = Vec::new();
    let mut kept = Vec::new();
    for (flat, live) in std::mem::take(&mut lowering.flat).into_iter().zip(live) {
        if live {
            kept.push(flat);
            continue;
        }
        let mut names: Vec<String> = flat
            .pass
            .accesses
            .iter()
            .filter(|a| a.write)
            .map(|a| lowering.objects[lowering.object_id(a.object)].object.path.clone())
            .collect();
        names.dedup();
        let why = match names.as_slice() {
            [] => "it writes nothing".to_owned(),
            _ => format!("no output needs {}", super::lower::list(&names)),
        };
        culled.push(Culled { path: flat.pass.path, why, span: flat.word });
    }
    lowering.flat = kept;
    culled
}

/// For each object, which of its subresources.
type Parts = Vec<Vec<bool>>;

/// What is needed after it was last written in the list, because something runs again.
#[derive(PartialEq)]
struct Carried {
    /// State that a live pass reads: the next frame's does too.
    state: Vec<ObjectId>,
    /// For each `Steps` what a step reads before it writes it: of objects, the subresources.
    steps: Vec<Vec<(ObjectId, usize)>>,
}

/// Which passes are live if the roots and what is carried are needed, and what these carry.
fn live_passes(lowering: &Lowering<'_>, roots: &[ObjectId], carried: &Carried) -> (Vec<bool>, Carried) {
    let mut needed: Parts = lowering
        .objects
        .iter()
        .map(|b| match &b.object.kind {
            super::model::ObjectKind::Texture(t) => vec![false; (t.mips * if t.is_3d { 1 } else { t.layers }) as usize],
            super::model::ObjectKind::Buffer(_) => vec![false],
        })
        .collect();
    for id in roots.iter().chain(&carried.state) {
        needed[*id].fill(true);
    }
    let is_state = |id: ObjectId| matches!(lowering.objects[id].object.origin, Origin::State(_));
    let mut live = vec![false; lowering.flat.len()];
    let mut state = Vec::new();
    let mut steps: Vec<BTreeSet<(ObjectId, usize)>> = vec![BTreeSet::new(); lowering.steps.len()];
    let mut open = None;
    for (p, flat) in lowering.flat.iter().enumerate().rev() {
        // From behind, a block of steps begins with what the next step will read.
        if flat.pass.steps != open {
            open = flat.pass.steps;
            for (id, sub) in open.iter().flat_map(|index| &carried.steps[*index]) {
                needed[*id][*sub] = true;
            }
        }
        let wanted = flat.pass.accesses.iter().filter(|a| a.write).any(|access| {
            lowering
                .object_ids(access.object)
                .into_iter()
                .any(|id| subresources(lowering, id, access, false).any(|sub| needed[id][sub]))
        });
        if !wanted {
            continue;
        }
        live[p] = true;
        for access in flat.pass.accesses.iter().filter(|a| a.whole) {
            let id = lowering.object_id(access.object);
            for sub in subresources(lowering, id, access, false) {
                match open {
                    // What a step wrote is still there in the next frame, and no step may run in this one.
                    Some(index) => _ = steps[index].remove(&(id, sub)),
                    None if !is_state(id) => needed[id][sub] = false,
                    None => {}
                }
            }
        }
        for (access, place) in flat.pass.accesses.iter().zip(&flat.places).filter(|(a, _)| a.read) {
            for id in lowering.object_ids(access.object) {
                for sub in subresources(lowering, id, access, place.samples_mips) {
                    needed[id][sub] = true;
                    steps.get_mut(open.unwrap_or(usize::MAX)).map(|inside| inside.insert((id, sub)));
                }
                if is_state(id) {
                    state.push(id);
                }
            }
        }
    }
    state.sort_unstable();
    state.dedup();
    (live, Carried { state, steps: steps.into_iter().map(|inside| inside.into_iter().collect()).collect() })
}
