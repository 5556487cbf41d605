//! A plan as text: order, units and why they run, resources with their lifetimes, memory, needs.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::rows::{self, Row, rows, shared};
use super::{describe, memory};
use crate::graph::value::Value;
use crate::plan::merge::{Shared, SharedKind};
use crate::plan::model::{Causes, ObjectId, Origin, Plan};
use crate::plan::needs::feature_names;

/// Names longer than this push what follows out of its column.
const WIDEST: usize = 40;

/// The whole plan as text.
pub fn text(plan: &Plan) -> String {
    let mut out = String::new();
    let [w, h] = plan.viewport;
    _ = writeln!(out, "plan of {} at {w} x {h}\n", plan.graph.display());
    passes(plan, &mut out);
    order(plan, &mut out);
    units(plan, &mut out);
    steps(plan, &mut out);
    resources(plan, &mut out);
    stats(plan, &mut out);
    memory::text(plan, &mut out);
    needs(plan, &mut out);
    params(plan, &mut out);
    files(plan, &mut out);
    out
}

fn passes(plan: &Plan, out: &mut String) {
    let culled = if plan.culled.is_empty() { String::new() } else { format!(", {} culled", plan.culled.len()) };
    _ = writeln!(out, "passes: {} in order{culled}; below each what it reads -> what it writes", plan.passes.len());
    let rows = rows(plan);
    let width = rows.iter().map(|row| rows::path(plan, row).len()).max().unwrap_or(0).min(WIDEST);
    for row in &rows {
        if row.stride > 1 && row.first == row.all.start {
            let (first, last) = (row.all.start, row.all.end - 1);
            _ = writeln!(out, "       passes {first} to {last}: these {}, {} times", row.stride, row.times);
        }
        pass(plan, row, width, out);
    }
    if plan.passes.iter().any(|p| p.unordered) {
        _ = writeln!(out, "  ~ the order of atomics may show in what it writes");
    }
    let width = plan.culled.iter().map(|culled| culled.path.len()).max().unwrap_or(0).min(WIDEST);
    for culled in &plan.culled {
        _ = writeln!(out, "  culled  {:width$}  {}", culled.path, culled.why);
    }
    out.push('\n');
}

fn pass(plan: &Plan, row: &Row, width: usize, out: &mut String) {
    let pass = &plan.passes[row.first];
    let mark = if pass.unordered { " ~" } else { "" };
    let steps = if pass.steps.is_some() { " (each step)" } else { "" };
    let unit = format!("u{}", pass.unit);
    let (path, what) = (rows::path(plan, row), rows::what(plan, row));
    _ = writeln!(out, "  {:>4} {unit:<5} {path:width$}  {what}{steps}{mark}", row.first);
    let side = |read: bool| {
        let names = rows::sides(plan, row, read);
        if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
    };
    _ = writeln!(out, "               {} -> {}", side(true), side(false));
}

/// Which passes share one of the device's, and what that took.
fn order(plan: &Plan, out: &mut String) {
    let all = rows::shared_passes(plan);
    let on_device = all.iter().filter(|s| s.kind != SharedKind::Alone).count();
    let is_shared = |s: &&Shared| s.passes.len() > 1;
    _ = writeln!(out, "passes of the device: {on_device}, if all run");
    for shared in all.iter().filter(is_shared) {
        let what = match shared.kind {
            SharedKind::Compute => "share a compute pass: dispatches that follow each other",
            _ => "share a render pass: they draw into the same targets",
        };
        _ = writeln!(out, "  {} {what}", ranges(&shared.passes.clone().collect::<Vec<_>>()));
    }
    for moved in &plan.order.moved {
        let passes = ranges(&moved.passes.clone().collect::<Vec<_>>());
        let before = &plan.passes[moved.before].path;
        _ = writeln!(
            out,
            "  {passes} before {} ({before}), which the program has first: they touch nothing of it",
            moved.before
        );
    }
    for folded in &plan.order.folded {
        _ = writeln!(out, "  the clear {} is how {} loads its target", folded.clear, folded.into);
    }
    out.push('\n');
}

fn units(plan: &Plan, out: &mut String) {
    _ = writeln!(out, "units: {}; the passes of a unit run together, when one of its causes changes", plan.units.len());
    // Units whose causes no earlier one has, to say the rest by.
    let mut known: Vec<usize> = Vec::new();
    let mut lines: Vec<(String, String)> = Vec::new();
    for (u, unit) in plan.units.iter().enumerate() {
        let what = if unit.passes.len() == 1 { "pass" } else { "passes" };
        let (bases, rest) = bases(plan, &known, &unit.causes);
        let mut parts: Vec<String> = Vec::new();
        if !bases.is_empty() {
            let names: Vec<String> = bases.iter().map(|k| format!("u{k}")).collect();
            parts.push(format!("as {}", names.join(" and ")));
        }
        if bases.is_empty() || !rest.is_empty() {
            parts.push(causes(&rest));
        }
        let why = parts.join("; ");
        if bases.len() != 1 || !rest.is_empty() {
            known.push(u);
        }
        lines.push((format!("{what} {}", ranges(&unit.passes)), why));
    }
    let width = lines.iter().map(|(passes, _)| passes.len()).max().unwrap_or(0).min(WIDEST);
    for (u, (passes, causes)) in lines.iter().enumerate() {
        _ = writeln!(out, "  {:<5} {passes:width$}  {causes}", format!("u{u}"));
    }
    out.push('\n');
}

/// Up to two of the known units whose causes are among these, and those that they leave.
fn bases(plan: &Plan, known: &[usize], all: &Causes) -> (Vec<usize>, Causes) {
    let (mut chosen, mut rest) = (Vec::new(), all.clone());
    while chosen.len() < 2 {
        let gain = |k: usize| rest.len() - rest.without(&plan.units[k].causes).len();
        let inside = known.iter().copied().filter(|k| within(&plan.units[*k].causes, all));
        // The first of equals.
        let best = inside.map(|k| (gain(k), k)).max_by_key(|(gain, k)| (*gain, std::cmp::Reverse(*k)));
        let Some((gain, k)) = best.filter(|(gain, _)| *gain > 2 || (*gain > 0 && *gain == rest.len())) else { break };
        debug_assert!(gain > 0, "a base takes something away");
        rest = rest.without(&plan.units[k].causes);
        chosen.push(k);
    }
    (chosen, rest)
}

fn within(a: &Causes, b: &Causes) -> bool {
    a.inputs.is_subset(&b.inputs)
        && a.live.is_subset(&b.live)
        && a.params.is_subset(&b.params)
        && (b.viewport || !a.viewport)
}

/// `3, 5 to 9`.
fn ranges(numbers: &[usize]) -> String {
    let mut parts: Vec<(usize, usize)> = Vec::new();
    for n in numbers {
        match parts.last_mut() {
            Some((_, last)) if *last + 1 == *n => *last = *n,
            _ => parts.push((*n, *n)),
        }
    }
    let text = |(a, b): &(usize, usize)| match b - a {
        0 => a.to_string(),
        1 => format!("{a}, {b}"),
        _ => format!("{a} to {b}"),
    };
    parts.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// Causes in one line.
pub fn causes(causes: &Causes) -> String {
    let mut parts = Vec::new();
    let join = |set: &BTreeSet<String>| set.iter().cloned().collect::<Vec<_>>().join(", ");
    if !causes.inputs.is_empty() {
        parts.push(format!("inputs {}", join(&causes.inputs)));
    }
    if !causes.live.is_empty() {
        parts.push(format!("frame {}", fields(&causes.live)));
    }
    if !causes.params.is_empty() {
        parts.push(format!("parameters {}", join(&causes.params)));
    }
    if causes.viewport {
        parts.push("viewport".to_owned());
    }
    if parts.is_empty() { "nothing: it runs once".to_owned() } else { parts.join("; ") }
}

/// Fields of one input together: `camera.(far, near), time`.
fn fields(live: &BTreeSet<String>) -> String {
    let mut of: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for name in live {
        let (input, field) = name.split_once('.').unwrap_or((name, ""));
        of.entry(input).or_default().push(field);
    }
    let text = |(input, fields): (&str, Vec<&str>)| match fields.as_slice() {
        [""] => input.to_owned(),
        [field] => format!("{input}.{field}"),
        fields => format!("{input}.({})", fields.join(", ")),
    };
    of.into_iter().map(text).collect::<Vec<_>>().join(", ")
}

fn steps(plan: &Plan, out: &mut String) {
    if plan.steps.is_empty() {
        return;
    }
    _ = writeln!(out, "steps:");
    for (index, steps) in plan.steps.iter().enumerate() {
        let rate = steps.rate.map_or("once a frame".to_owned(), |rate| format!("{rate} Hz"));
        let passes = match steps.passes.len() {
            0 => "no passes".to_owned(),
            1 => format!("pass {}", steps.passes.start),
            _ => format!("passes {}", ranges(&steps.passes.clone().collect::<Vec<_>>())),
        };
        _ = writeln!(out, "  {}  {rate}, {passes}", steps.path);
        let state: Vec<&str> = steps.state.iter().map(|id| plan.objects[*id].path.as_str()).collect();
        if !state.is_empty() {
            _ = writeln!(out, "    state {}", state.join(", "));
        }
        for ring in plan.rings.iter().filter(|ring| ring.steps == index) {
            let names: Vec<&str> = ring.objects.iter().map(|id| plan.objects[*id].path.as_str()).collect();
            _ = writeln!(out, "    {} turn by {} after each step", names.join(", "), ring.turn);
        }
    }
    out.push('\n');
}

fn resources(plan: &Plan, out: &mut String) {
    _ = writeln!(out, "resources: {}; with the passes that they live in", plan.objects.len());
    let shapes: Vec<String> = plan.objects.iter().map(describe::shape).collect();
    let names = plan.objects.iter().map(|o| o.path.len()).max().unwrap_or(0).min(WIDEST);
    let width = shapes.iter().map(String::len).max().unwrap_or(0).min(WIDEST);
    let shared = shared(plan);
    for (id, object) in plan.objects.iter().enumerate() {
        let life = match object.lifetime {
            Some((first, last)) if first == last => format!("{first}"),
            Some((first, last)) => format!("{first} to {last}"),
            None => "unused".to_owned(),
        };
        let (shape, size) = (&shapes[id], rows::size(plan, id));
        let notes = notes(plan, id, shared.get(&id)).join(", ");
        let line = format!("  {:names$}  {shape:width$}  {size:>10}  {life:<12} {notes}", object.path);
        _ = writeln!(out, "{}", line.trim_end());
    }
    let outputs: Vec<String> = (plan.outputs.iter())
        .map(|output| match describe::name(plan, output.object) {
            same if same == output.name => same,
            other => format!("{} ({other})", output.name),
        })
        .collect();
    _ = writeln!(out, "  outputs: {}\n", outputs.join(", "));
}

/// What is special about an object.
fn notes(plan: &Plan, id: ObjectId, shared: Option<&String>) -> Vec<String> {
    let mut notes = Vec::new();
    match &plan.objects[id].origin {
        Origin::Frame => {}
        Origin::State(steps) => {
            let path = plan.steps.get(*steps).map_or("no steps", |s| s.path.as_str());
            notes.push(format!("state of {path}"));
        }
        Origin::Input(input) => notes.push(format!("input {input}")),
        Origin::Attribute { input, present, .. } => {
            let absent = if *present { "" } else { " (absent: zeros)" };
            notes.push(format!("attribute of {input}{absent}"));
        }
        Origin::Mesh { input, .. } if input.is_empty() => notes.push("meshes that nothing feeds".to_owned()),
        Origin::Mesh { input, .. } => notes.push(format!("meshes of {input}")),
    }
    if plan.outputs.iter().any(|output| rows::id(plan, output.object) == id) {
        notes.push("output".to_owned());
    }
    if plan.memory.unstored.contains(&id) {
        notes.push("transient".to_owned());
    }
    notes.extend(shared.map(|label| format!("shares {label}")));
    notes
}

fn stats(plan: &Plan, out: &mut String) {
    if plan.stats.is_empty() {
        return;
    }
    _ = writeln!(out, "statistics: {}; passes that only they need run when somebody asks", plan.stats.len());
    let width = plan.stats.iter().map(|stat| stat.path.len()).max().unwrap_or(0).min(WIDEST);
    for stat in &plan.stats {
        let missing =
            stat.missing.as_ref().map_or(String::new(), |name| format!("  (no value: nothing writes {name})"));
        _ = writeln!(out, "  {:width$}  {}{missing}", stat.path, stat.text);
    }
    out.push('\n');
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
    let width = plan.params.iter().map(|param| param.path.len()).max().unwrap_or(0).min(WIDEST);
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
        _ = writeln!(out, "  {:width$}  {}{unit}{range}{changed}", param.path, param.value);
    }
    out.push('\n');
}

/// `1` and `1.0` say the same of a Float.
fn same(a: &Value, b: &Value) -> bool {
    a.components().len() == b.components().len()
        && a.components().zip(b.components()).all(|(x, y)| x == y || (x.as_f64().is_some() && x.as_f64() == y.as_f64()))
}

fn files(plan: &Plan, out: &mut String) {
    _ = writeln!(out, "files:");
    let width = plan.taken.keys().map(String::len).max().unwrap_or(0).min(WIDEST);
    for (name, path) in &plan.taken {
        _ = writeln!(out, "  {name:width$}  {}", path.display());
    }
}
