//! Targets that no render pass has to store: each that draws into them clears them first, and nothing
//! else touches them, but that they are resolved. A device that keeps pixels in tiles then writes
//! nothing back, and may have no memory for them at all.

use std::collections::BTreeSet;

use super::merge;
use super::model::{Apart, Bound, Draw, ObjectId, ObjectKind, ObjectRef, Origin, PassKind, Plan};

/// Such targets of a plan, if its draws share render passes as `leaders` says: of each pass the first
/// one of its render pass.
pub fn unstored(plan: &Plan, leaders: &[usize]) -> BTreeSet<ObjectId> {
    let may = |id: &ObjectId| {
        let object = &plan.objects[*id];
        let is_looked_at = plan.memory.apart.get(id) == Some(&Apart::LookedAt);
        let is_target = matches!(&object.kind, ObjectKind::Texture(t) if !t.is_3d && !t.format.has_stencil_aspect());
        is_target && object.origin == Origin::Frame && object.lifetime.is_some() && !is_looked_at
    };
    let mut found: BTreeSet<ObjectId> = (0..plan.objects.len()).filter(may).collect();
    let ids = |object: ObjectRef| merge::candidates(plan, object);
    for (at, pass) in plan.passes.iter().enumerate() {
        let PassKind::Draw(draw) = &pass.kind else {
            let touched = pass.accesses.iter().flat_map(|access| ids(access.object));
            touched.for_each(|id| _ = found.remove(&id));
            continue;
        };
        let loaded = targets(draw).filter(|(_, clears)| leaders[at] == at && !clears).map(|(object, _)| object);
        others(draw).chain(loaded).flat_map(ids).for_each(|id| _ = found.remove(&id));
    }
    found
}

/// What a draw draws into, and whether it clears that.
fn targets(draw: &Draw) -> impl Iterator<Item = (ObjectRef, bool)> {
    let colors = draw.color.iter().map(|target| (target.view.object, target.clear.is_some()));
    colors.chain(draw.depth.iter().map(|depth| (depth.view.object, depth.clear.is_some())))
}

/// Textures that a draw touches besides.
fn others(draw: &Draw) -> impl Iterator<Item = ObjectRef> {
    let resolved = draw.color.iter().filter_map(|target| target.resolve.as_ref()).map(|view| view.object);
    let bound = draw.shader.bindings.iter().filter_map(|binding| match &binding.bound {
        Bound::Texture { view, .. } | Bound::StorageTexture { view, .. } => Some(view.object),
        _ => None,
    });
    resolved.chain(bound)
}
