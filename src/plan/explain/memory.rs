//! Where the memory of a resource lies, and with whom it is shared or why with nobody.

use super::some;
use crate::plan::memory::class;
use crate::plan::model::{Apart, Cut, ObjectId, ObjectRef, Origin, Plan, Policy};
use crate::plan::print::causes;

/// Every object that a reference can stand for.
pub(super) fn candidates(plan: &Plan, object: ObjectRef) -> Vec<ObjectId> {
    match object {
        ObjectRef::Fixed(id) => vec![id],
        ObjectRef::Ring { ring, .. } => plan.rings[ring].objects.clone(),
    }
}

pub(super) fn explain(plan: &Plan, id: ObjectId) -> Vec<String> {
    match (&plan.objects[id].origin, plan.objects[id].lifetime) {
        (Origin::State(_), _) => return vec!["its own: state survives the frame".into()],
        (Origin::Frame, None) => return vec!["none: no pass that runs touches it".into()],
        (Origin::Frame, Some((first, last))) => {
            let mut said =
                vec![format!("lives from pass {first} ({}) to {last} ({})", path(plan, first), path(plan, last))];
            said.extend(Policy::ALL.map(|policy| {
                let now = if policy == plan.memory.policy { " (which holds)" } else { "" };
                format!("under \"{}\"{now}: {}{}", policy.name(), under(plan, id, policy), between(plan, id, policy))
            }));
            return said;
        }
        _ => {}
    }
    vec!["its own: it comes from outside".into()]
}

fn path(plan: &Plan, pass: usize) -> &str {
    plan.passes.get(pass).map_or("none", |pass| &pass.path)
}

fn under(plan: &Plan, id: ObjectId, policy: Policy) -> String {
    let slot = plan.memory.slots(policy).iter().find(|slot| slot.objects.contains(&id));
    let others: Vec<String> = slot
        .map_or(&[][..], |slot| &slot.objects)
        .iter()
        .filter(|other| **other != id)
        .map(|o| lived(plan, *o))
        .collect();
    if !others.is_empty() {
        let others: Vec<&str> = others.iter().map(String::as_str).collect();
        return format!("shared with {}", some(&others));
    }
    match plan.memory.apart.get(&id).filter(|_| policy == Policy::Keep) {
        Some(apart) => format!("its own: {}", why_apart(plan, *apart)),
        None => format!("its own: {}", why_alone(plan, id, policy)),
    }
}

/// At which cuts of the frame its memory is made and given back.
fn between(plan: &Plan, id: ObjectId, policy: Policy) -> String {
    let cuts = plan.memory.cuts(policy);
    let Some(slot) = plan.memory.slots(policy).iter().position(|slot| slot.objects.contains(&id)) else {
        return String::new();
    };
    let cut = |cut: &Cut| format!("at the cut before {} ({})", cut.before, path(plan, cut.before));
    let made = cuts.iter().find(|cut| cut.makes.contains(&slot)).map(|at| format!("; made {}", cut(at)));
    let given = cuts.iter().find(|cut| cut.gives.contains(&slot)).map(|at| format!("; given back {}", cut(at)));
    made.into_iter().chain(given).collect()
}

/// `name (3 to 7)`.
fn lived(plan: &Plan, id: ObjectId) -> String {
    let object = &plan.objects[id];
    object.lifetime.map_or_else(|| object.path.clone(), |(first, last)| format!("{} ({first} to {last})", object.path))
}

fn why_apart(plan: &Plan, apart: Apart) -> String {
    match apart {
        Apart::LookedAt => "it is an output or was asked for, and is looked at after the frame".into(),
        Apart::Steps => "steps touch it and others too, and a frame may run no step to make it again".into(),
        Apart::Causes { units: [a, b] } => {
            let only = |a: usize, b: usize| {
                let less = plan.units[a].causes.without(&plan.units[b].causes);
                (!less.is_empty()).then(|| format!("u{a} also for {}", causes(&less)))
            };
            let differences: Vec<String> = [only(a, b), only(b, a)].into_iter().flatten().collect();
            format!(
                "u{a} ({}) and u{b} ({}) touch it and run for different causes ({}): one may run while the other keeps it",
                path(plan, plan.units[a].passes[0]),
                path(plan, plan.units[b].passes[0]),
                differences.join(", ")
            )
        }
    }
}

/// Why nothing else came to lie with what may share.
fn why_alone(plan: &Plan, id: ObjectId, policy: Policy) -> String {
    let of = class(&plan.objects[id].kind);
    let alike: Vec<ObjectId> = (0..plan.objects.len())
        .filter(|other| *other != id && plan.objects[*other].origin == Origin::Frame)
        .filter(|other| plan.objects[*other].lifetime.is_some() && class(&plan.objects[*other].kind) == of)
        .collect();
    let what = if of.is_some() { "textures that are described alike" } else { "buffers" };
    if alike.is_empty() {
        return format!("there are no other {what}");
    }
    let may: Vec<ObjectId> =
        alike.into_iter().filter(|id| policy != Policy::Keep || !plan.memory.apart.contains_key(id)).collect();
    if may.is_empty() {
        return format!("all other {what} have memory of their own");
    }
    let meets = |other: &ObjectId| match (plan.objects[id].lifetime, plan.objects[*other].lifetime) {
        (Some((a, b)), Some((c, d))) => a <= d && c <= b,
        _ => false,
    };
    let living: Vec<String> = may.iter().filter(|other| meets(other)).map(|other| lived(plan, *other)).collect();
    let living: Vec<&str> = living.iter().map(String::as_str).collect();
    match living.as_slice() {
        [] if !plan.memory.cuts(policy).is_empty() => format!("the other {what} lie better elsewhere or behind a cut"),
        [] => format!("the other {what} lie better elsewhere"),
        living if living.len() == may.len() => format!("all that could share live at the same time: {}", some(living)),
        living => format!("{} live at the same time, and the others lie better elsewhere", some(living)),
    }
}
