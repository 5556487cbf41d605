//! A plan as text: order, units and why they run, resources with their lifetimes, memory, needs.

use std::fmt::Write as _;

use super::describe;
use crate::graph::value::Value;
use crate::plan::model::{Causes, Object, Origin, Pass, Plan, Slot};
use crate::plan::needs::feature_names;

/// The whole plan as text.
pub fn text(plan: &Plan) -> String {
    let mut out = String::new();
    let [w, h] = plan.viewport;
    _ = writeln!(out, "plan of {} at {w} x {h}\n", plan.graph.display());
    passes(plan, &mut out);
    units(plan, &mut out);
    resources(plan, &mut out);
    memory(plan, &mut out);
    needs(plan, &mut out);
    params(plan, &mut out);
    files(plan, &mut out);
    out
}

fn passes(plan: &Plan, out: &mut String) {
    _ = writeln!(out, "passes: {} in program order", plan.passes.len());
    let paths: Vec<&str> = plan.passes.iter().map(|p| p.path.as_str()).collect();
    let width = paths.iter().map(|p| p.len()).max().unwrap_or(0).min(40);
    for (p, pass) in plan.passes.iter().enumerate() {
        let mark = if pass.unordered { " ~" } else { "" };
        let steps = if pass.steps.is_some() { " (step)" } else { "" };
        _ = writeln!(out, "  {p:>3}  u{:<3} {:width$}  {}{steps}{mark}", pass.unit, pass.path, describe::pass(pass));
        _ = writeln!(out, "            {}", flow(plan, pass));
    }
    if plan.passes.iter().any(|p| p.unordered) {
        _ = writeln!(out, "  ~ the order of atomics may show in what it writes");
    }
    for culled in &plan.culled {
        _ = writeln!(out, "  culled {}: {}", culled.path, culled.why);
    }
    out.push('\n');
}

fn flow(plan: &Plan, pass: &Pass) -> String {
    let side = |read: bool| {
        let mut names: Vec<String> = pass
            .accesses
            .iter()
            .filter(|a| if read { a.read } else { a.write })
            .map(|a| describe::access(plan, a))
            .collect();
        names.dedup();
        if names.is_empty() { "-".to_owned() } else { names.join(", ") }
    };
    format!("{} -> {}", side(true), side(false))
}

fn units(plan: &Plan, out: &mut String) {
    _ = writeln!(out, "units: {}, each runs when one of its causes changes", plan.units.len());
    for (u, unit) in plan.units.iter().enumerate() {
        let numbers: Vec<String> = unit.passes.iter().map(usize::to_string).collect();
        let numbers = if numbers.len() > 6 {
            format!("{}, ... {}", numbers[..4].join(", "), numbers[numbers.len() - 1])
        } else {
            numbers.join(", ")
        };
        _ = writeln!(out, "  u{u:<3} passes {numbers}: {}", causes(&unit.causes));
    }
    out.push('\n');
}

/// Causes in one line.
pub(super) fn causes(causes: &Causes) -> String {
    let mut parts = Vec::new();
    let join = |set: &std::collections::BTreeSet<String>| set.iter().cloned().collect::<Vec<_>>().join(", ");
    if !causes.inputs.is_empty() {
        parts.push(format!("inputs {}", join(&causes.inputs)));
    }
    if !causes.live.is_empty() {
        parts.push(format!("frame {}", join(&causes.live)));
    }
    if !causes.params.is_empty() {
        parts.push(format!("parameters {}", join(&causes.params)));
    }
    if causes.viewport {
        parts.push("viewport".to_owned());
    }
    if parts.is_empty() { "nothing: it runs once".to_owned() } else { parts.join("; ") }
}

fn resources(plan: &Plan, out: &mut String) {
    _ = writeln!(out, "resources:");
    let width = plan.objects.iter().map(|o| o.path.len()).max().unwrap_or(0).min(40);
    for object in &plan.objects {
        _ = writeln!(out, "  {:width$}  {}{}", object.path, describe::object(object), origin(plan, object));
    }
    let outputs: Vec<String> = plan.outputs.iter().map(|o| o.name.clone()).collect();
    _ = writeln!(out, "  outputs: {}\n", outputs.join(", "));
}

fn origin(plan: &Plan, object: &Object) -> String {
    let lifetime = match object.lifetime {
        Some((first, last)) => format!(", passes {first} to {last}"),
        None => ", unused".to_owned(),
    };
    match &object.origin {
        Origin::Frame => lifetime,
        Origin::State(steps) => {
            let path = plan.steps.get(*steps).map_or("?", |s| s.path.as_str());
            format!("{lifetime}, state of {path}")
        }
        Origin::Input(input) => format!("{lifetime}, input {input}"),
        Origin::Attribute { input, present, .. } => {
            let absent = if *present { "" } else { " (absent: zeros)" };
            format!("{lifetime}, attribute of {input}{absent}")
        }
    }
}

fn memory(plan: &Plan, out: &mut String) {
    let total = |slots: &[Slot]| slots.iter().map(|s| s.bytes).sum::<u64>();
    let memory = &plan.memory;
    _ = writeln!(out, "memory of the frame:");
    _ = writeln!(out, "  {} without sharing", describe::bytes(memory.unshared));
    for (policy, slots) in [("keep", &memory.keep), ("smallest", &memory.smallest)] {
        _ = writeln!(out, "  {} under the policy \"{policy}\"", describe::bytes(total(slots)));
        for slot in slots.iter().filter(|s| s.objects.len() > 1) {
            let names: Vec<&str> = slot.objects.iter().map(|id| plan.objects[*id].path.as_str()).collect();
            _ = writeln!(out, "    shared: {}", names.join(", "));
        }
    }
    _ = writeln!(out, "  {} in the largest live set\n", describe::bytes(memory.lower_bound));
}

fn needs(plan: &Plan, out: &mut String) {
    let features = feature_names(plan.needs.features);
    if features.is_empty() && plan.needs.limits.is_empty() {
        _ = writeln!(out, "needs: nothing beyond WebGPU's defaults\n");
        return;
    }
    _ = writeln!(out, "needs, beyond WebGPU's defaults:");
    for feature in features {
        _ = writeln!(out, "  feature {feature}");
    }
    for (name, needed, default) in &plan.needs.limits {
        _ = writeln!(out, "  {name} {needed} (default {default})");
    }
    out.push('\n');
}

fn params(plan: &Plan, out: &mut String) {
    if plan.params.is_empty() {
        return;
    }
    _ = writeln!(out, "parameters:");
    for param in &plan.params {
        let unit = param.unit.as_ref().map_or(String::new(), |u| format!(" {u}"));
        let range = match (&param.min, &param.max) {
            (Some(min), Some(max)) => format!(" [{min} to {max}]"),
            (Some(min), None) => format!(" [from {min}]"),
            (None, Some(max)) => format!(" [up to {max}]"),
            (None, None) => String::new(),
        };
        let changed = match &param.default {
            Some(default) if *default != param.value && !same(default, &param.value) => format!(" (default {default})"),
            _ => String::new(),
        };
        _ = writeln!(out, "  {} = {}{unit}{range}{changed}", param.path, param.value);
    }
    out.push('\n');
}

/// `1` and `1.0` say the same of a Float.
fn same(a: &Value, b: &Value) -> bool {
    a.components().len() == b.components().len()
        && a.components()
            .iter()
            .zip(b.components())
            .all(|(x, y)| x == y || (x.as_f64().is_some() && x.as_f64() == y.as_f64()))
}

fn files(plan: &Plan, out: &mut String) {
    _ = writeln!(out, "files:");
    for (name, path) in &plan.taken {
        _ = writeln!(out, "  {name} from {}", path.display());
    }
}
