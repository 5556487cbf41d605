//! The memory of a plan as text: what each policy holds, where the frame is cut, and the bounds.

use std::cmp::Reverse;
use std::fmt::Write as _;

use super::describe;
use crate::plan::memory;
use crate::plan::model::{Cut, Memory, Plan, Policy, Slot};

/// How many of the largest pieces of memory are named at a cut.
const NAMED: usize = 4;

pub(super) fn text(plan: &Plan, out: &mut String) {
    let memory = &plan.memory;
    _ = writeln!(out, "memory of the frame:");
    _ = writeln!(out, "  {:>10}  without sharing", describe::bytes(memory.unshared));
    if !memory.unstored.is_empty() {
        let bytes = memory.unstored.iter().map(|id| memory::bytes(&plan.objects[*id].kind)).sum();
        let transient = describe::bytes(bytes);
        _ = writeln!(
            out,
            "  {transient:>10}  of it in transient targets: no pass stores them, and a device may have no memory for them"
        );
    }
    for policy in Policy::ALL {
        under(plan, policy, out);
    }
    let alike = describe::bytes(memory.alike_bound);
    _ = writeln!(
        out,
        "  {alike:>10}  in the largest live sets of what is described alike: without cuts wgpu lets no plan hold less"
    );
    let at = plan
        .passes
        .get(memory.largest_at)
        .map_or(String::new(), |p| format!(", at {} ({})", memory.largest_at, p.path));
    let least = describe::bytes(memory.lower_bound);
    _ = writeln!(out, "  {least:>10}  in the largest live set{at}: no plan can hold less");
    let budget = memory.budget.map_or(String::new(), |budget| format!(", of a budget of {}", describe::bytes(budget)));
    let (name, why) = (memory.policy.name(), &memory.why);
    let [held, outside] = [memory.held(memory.policy), memory.outside].map(describe::bytes);
    let most = if memory.cuts(memory.policy).is_empty() { "" } else { " at the most" };
    _ = writeln!(out, "  the policy is \"{name}\": {why}");
    _ = writeln!(out, "  held: {held}{most}{budget}, with {outside} of inputs and state\n");
}

fn under(plan: &Plan, policy: Policy, out: &mut String) {
    let memory = &plan.memory;
    let (cuts, name, held) = (memory.cuts(policy), policy.name(), describe::bytes(memory.of_frame(policy)));
    let what = match policy {
        Policy::Keep => "what skipping needs is kept".to_owned(),
        Policy::Share => "every unit runs each frame".to_owned(),
        Policy::Smallest if cuts.is_empty() => "the same, since it needs no cut of the frame".to_owned(),
        Policy::Smallest => format!("the same, and the frame is cut {}", times(cuts.len())),
    };
    _ = writeln!(out, "  {held:>10}  under the policy \"{name}\": {what}{}", to_bound(memory, policy));
    if policy == Policy::Smallest && cuts.is_empty() && memory.policy != policy {
        return;
    }
    let is_told = |slot: &Slot| policy == Policy::Smallest && memory.policy != policy && memory.share.contains(slot);
    let shared = memory.slots(policy).iter().filter(|slot| slot.objects.len() > 1);
    for (n, slot) in shared.enumerate().filter(|(_, slot)| !is_told(slot)) {
        let names: Vec<&str> = slot.objects.iter().map(|id| plan.objects[*id].path.as_str()).collect();
        let label = if policy == memory.policy { format!("m{n}: ") } else { String::new() };
        _ = writeln!(out, "  {:>10}    {label}{}", describe::bytes(slot.bytes), names.join(", "));
    }
    for (cut, held) in cuts.iter().zip(memory.parts.windows(2)) {
        let path = plan.passes.get(cut.before).map_or("none", |pass| &pass.path);
        let [before, behind] = [held[0], held[1]].map(describe::bytes);
        let parts: Vec<String> = changes(plan, cut).into_iter().map(|(does, what)| format!("{does} {what}")).collect();
        _ = writeln!(
            out,
            "  {before:>10}    up to a cut before {} ({path}), which {}",
            cut.before,
            parts.join(", and ")
        );
        if std::ptr::eq(cut, &cuts[cuts.len() - 1]) {
            _ = writeln!(out, "  {behind:>10}    behind it");
        }
    }
}

/// What a cut gives back, and what it makes.
fn changes(plan: &Plan, cut: &Cut) -> Vec<(&'static str, String)> {
    [("gives back", &cut.gives), ("makes", &cut.makes)]
        .into_iter()
        .filter(|(_, slots)| !slots.is_empty())
        .map(|(does, slots)| (does, pieces(plan, slots)))
        .collect()
}

fn pieces(plan: &Plan, slots: &[usize]) -> String {
    let mut slots: Vec<&Slot> = slots.iter().filter_map(|slot| plan.memory.smallest.get(*slot)).collect();
    let bytes = slots.iter().map(|slot| slot.bytes).sum();
    slots.sort_by_key(|slot| Reverse(slot.bytes));
    let first = |slot: &&Slot| slot.objects.first().map_or("none", |id| plan.objects[*id].path.as_str());
    let names: Vec<&str> = slots.iter().take(NAMED).map(first).collect();
    let more = slots.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{} ({}{more})", describe::bytes(bytes), names.join(", "))
}

fn times(count: usize) -> String {
    match count {
        1 => "once".into(),
        2 => "twice".into(),
        _ => format!("{count} times"),
    }
}

/// How much that is of what is live at once.
fn to_bound(memory: &Memory, policy: Policy) -> String {
    if memory.lower_bound == 0 || policy == Policy::Keep {
        return String::new();
    }
    let ratio = memory.of_frame(policy) as f64 / memory.lower_bound as f64;
    format!("; {ratio:.2} of what is live at once")
}
