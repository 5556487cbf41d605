//! Memory that holds nothing of use between what uses it, as clears in the plan.

use meniscus::format::{SampleKind, sample_kind};
use meniscus::plan::model::{ObjectId, ObjectKind, Origin, Pass, PassKind, Plan, Policy, View};
use meniscus::shader::reflect::{Scalar, TextureDimension, Type};

use crate::planning::objects;

/// Fills each object that shares memory under any policy with NaN, or what comes closest, before
/// the first pass that touches it.
pub fn shared(plan: &mut Plan) {
    let slots = Policy::ALL.into_iter().flat_map(|policy| plan.memory.slots(policy));
    let mut shared: Vec<ObjectId> = slots.filter(|s| s.objects.len() > 1).flat_map(|s| s.objects.clone()).collect();
    // What is made in the middle of a frame begins with nothing of use.
    let made = plan.memory.cuts.iter().flat_map(|cut| &cut.makes);
    shared.extend(made.flat_map(|slot| &plan.memory.smallest[*slot].objects));
    shared.sort_unstable();
    shared.dedup();
    // From behind, so that the places before stay.
    let mut clears: Vec<(usize, ObjectId)> = shared.into_iter().filter_map(|id| Some((first(plan, id)?, id))).collect();
    clears.sort_unstable();
    for (at, id) in clears.into_iter().rev() {
        insert(plan, at, id);
    }
}

/// The first pass that touches an object, if it is outside of steps and so is all of its unit.
fn first(plan: &Plan, id: ObjectId) -> Option<usize> {
    let touches = |pass: &Pass| pass.accesses.iter().any(|a| objects(plan, a.object).contains(&id));
    let at = plan.passes.iter().position(touches)?;
    let mut unit = plan.units[plan.passes[at].unit].passes.iter();
    let is_of_frame = plan.objects[id].origin == Origin::Frame;
    (is_of_frame && unit.all(|p| plan.passes[*p].steps.is_none())).then_some(at)
}

fn insert(plan: &mut Plan, at: usize, id: ObjectId) {
    // Another's poison may have come to lie here.
    let touched = |pass: &Pass| pass.accesses.iter().find(|a| objects(plan, a.object).contains(&id)).cloned();
    let (next, mut access) = plan.passes[at..].iter().find_map(|pass| Some((pass, touched(pass)?))).unwrap();
    let (mips, layers, value) = match &plan.objects[id].kind {
        ObjectKind::Texture(t) => {
            let is_float = matches!(sample_kind(t.format), SampleKind::Float);
            let norm = format!("{:?}", t.format).contains("norm");
            let value = if is_float && !norm { f64::NAN } else { 1.0 };
            (0..t.mips, 0..if t.is_3d { 1 } else { t.layers }, value)
        }
        ObjectKind::Buffer(b) => (0..1, 0..1, if is_float(b.item.as_ref()) { f64::NAN } else { 4_294_967_295.0 }),
    };
    (access.mips, access.layers) = (mips.clone(), layers.clone());
    (access.read, access.write, access.whole) = (false, true, true);
    let view = View { object: access.object, mips, layers, dimension: TextureDimension::D2 };
    let pass = Pass {
        path: format!("poison {}", plan.objects[id].path),
        span: next.span,
        unit: next.unit,
        steps: None,
        kind: PassKind::Clear { view, value: [value; 4] },
        accesses: vec![access],
        unordered: false,
    };
    plan.passes.insert(at, pass);
    for unit in &mut plan.units {
        unit.passes.iter_mut().filter(|p| **p >= at).for_each(|p| *p += 1);
    }
    let unit = plan.passes[at].unit;
    plan.units[unit].passes.push(at);
    plan.units[unit].passes.sort_unstable();
    plan.memory.cuts.iter_mut().filter(|cut| cut.before > at).for_each(|cut| cut.before += 1);
    for steps in plan.steps.iter_mut().filter(|steps| steps.passes.start >= at) {
        steps.passes = steps.passes.start + 1..steps.passes.end + 1;
    }
}

fn is_float(item: Option<&Type>) -> bool {
    match item {
        Some(
            Type::Scalar(scalar) | Type::Atomic(scalar) | Type::Vector { scalar, .. } | Type::Matrix { scalar, .. },
        ) => *scalar == Scalar::F32,
        Some(Type::Array { element, .. }) => is_float(Some(element)),
        Some(Type::Struct { members, .. }) => is_float(members.first().map(|m| &m.ty)),
        None => false,
    }
}
