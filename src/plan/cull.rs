//! Passes that nothing needs are left out, and said.

use super::flow::subresources;
use super::lower::Lowering;
use super::model::{Culled, ObjectId, Origin};

/// Keeps the passes that the roots need; gives back those that were left out.
pub(super) fn cull(lowering: &mut Lowering<'_>, roots: &[ObjectId]) -> Vec<Culled> {
    let mut state_read: Vec<ObjectId> = Vec::new();
    let live = loop {
        let (live, read) = live_passes(lowering, roots, &state_read);
        if read == state_read {
            break live;
        }
        state_read = read;
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

/// Which passes are live if the roots and the given state are needed after the last pass, and
/// the state that these read.
fn live_passes(lowering: &Lowering<'_>, roots: &[ObjectId], state: &[ObjectId]) -> (Vec<bool>, Vec<ObjectId>) {
    let mut needed: Vec<Vec<bool>> = lowering
        .objects
        .iter()
        .map(|b| match &b.object.kind {
            super::model::ObjectKind::Texture(t) => vec![false; (t.mips * if t.is_3d { 1 } else { t.layers }) as usize],
            super::model::ObjectKind::Buffer(_) => vec![false],
        })
        .collect();
    for id in roots.iter().chain(state) {
        needed[*id].fill(true);
    }
    let is_state = |id: ObjectId| matches!(lowering.objects[id].object.origin, Origin::State(_));
    let mut live = vec![false; lowering.flat.len()];
    let mut state_read = Vec::new();
    for (p, flat) in lowering.flat.iter().enumerate().rev() {
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
            // What a step wrote is still there in the next frame, and no step may run in this one.
            if !is_state(id) && flat.pass.steps.is_none() {
                for sub in subresources(lowering, id, access, false) {
                    needed[id][sub] = false;
                }
            }
        }
        for (access, place) in flat.pass.accesses.iter().zip(&flat.places).filter(|(a, _)| a.read) {
            for id in lowering.object_ids(access.object) {
                for sub in subresources(lowering, id, access, place.samples_mips) {
                    needed[id][sub] = true;
                }
                if is_state(id) && !state_read.contains(&id) {
                    state_read.push(id);
                }
            }
        }
    }
    state_read.sort_unstable();
    (live, state_read)
}
