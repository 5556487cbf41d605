//! Why a plan is as it is: for a pass, what makes it run and with what it shares a pass of the device; for a
//! resource, where its memory lies and with whom it is shared, or why with nobody.

mod memory;

use super::merge::{self, SharedKind};
use super::model::{ObjectId, Pass, Plan};
use super::print::{causes, object_id, rows};
use crate::diagnostic::{Code, Diagnostic, Sources, Span};

/// What there is to say of a pass or a resource.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// `pass`, `culled pass` or `resource`.
    pub kind: &'static str,
    /// Its instance path.
    pub path: String,
    /// What is said, by what it is about.
    pub facts: Vec<(&'static str, Vec<String>)>,
}

/// Explains what bears a name, or everything.
///
/// # Errors
/// If nothing in the plan bears the name.
pub fn explain(plan: &Plan, sources: &Sources, name: Option<&str>) -> Result<Vec<Explanation>, Box<Diagnostic>> {
    let is_meant = |path: &str| name.is_none_or(|name| name == path);
    let mut all = Vec::new();
    for row in rows(plan) {
        let mut paths = row.passes().map(|p| &plan.passes[p].path);
        // A loop also goes by its name alone, or by that of one iteration.
        if paths.any(|path| is_meant(path) || is_meant(&without_index(path))) {
            let chosen = row.passes().find(|p| is_meant(&plan.passes[*p].path)).unwrap_or(row.first);
            all.push(pass(plan, sources, chosen, row.times));
        }
    }
    for culled in plan.culled.iter().filter(|culled| is_meant(&culled.path)) {
        let facts = vec![("at", vec![place(sources, culled.span)]), ("culled", vec![culled.why.clone()])];
        all.push(Explanation { kind: "culled pass", path: culled.path.clone(), facts });
    }
    for id in 0..plan.objects.len() {
        let named = || plan.names.iter().any(|(path, object)| is_meant(path) && object_id(plan, *object) == id);
        if is_meant(&plan.objects[id].path) || named() {
            all.push(resource(plan, sources, id));
        }
    }
    match name.filter(|_| all.is_empty()) {
        None => Ok(all),
        Some(name) => Err(Box::new(unknown(plan, name))),
    }
}

fn unknown(plan: &Plan, name: &str) -> Diagnostic {
    let passes: Vec<String> = plan.passes.iter().map(|pass| without_index(&pass.path)).collect();
    let others = plan.culled.iter().map(|c| c.path.as_str()).chain(plan.names.keys().map(String::as_str));
    let known = passes.iter().map(String::as_str).chain(others);
    let message = format!("no pass and no resource is called `{name}`");
    Diagnostic::error(Code::USAGE, message).nearest(name, known).hint("`plan` lists them by their paths")
}

/// `smooth` of `smooth[3]`.
fn without_index(path: &str) -> String {
    let mut text = String::new();
    let mut depth = 0;
    for c in path.chars() {
        match c {
            '[' => depth += 1,
            ']' => depth -= 1,
            c if depth == 0 => text.push(c),
            _ => {}
        }
    }
    text
}

/// `graphs/it.ron:12`.
fn place(sources: &Sources, span: Span) -> String {
    let position = sources.position(span.file, span.start);
    format!("{}:{}", sources.path(span.file), position.line)
}

fn pass(plan: &Plan, sources: &Sources, at: usize, times: usize) -> Explanation {
    let pass = &plan.passes[at];
    let mut is = vec![format!("pass {at}: {}", super::print::pass(pass))];
    if times > 1 {
        is.push(format!("one of {times} like it in a loop"));
    }
    let mut facts = vec![
        ("is", is),
        ("at", vec![place(sources, pass.span)]),
        ("runs", runs(plan, pass)),
        ("causes", why(plan, pass.unit)),
        ("device", device(plan, at)),
    ];
    let order = order(plan, at);
    if !order.is_empty() {
        facts.push(("order", order));
    }
    Explanation { kind: "pass", path: pass.path.clone(), facts }
}

/// With what it runs.
fn runs(plan: &Plan, pass: &Pass) -> Vec<String> {
    let unit = &plan.units[pass.unit];
    let mut said = Vec::new();
    if let Some(steps) = pass.steps {
        said.push(format!("in each step of {}, and for nothing else", plan.steps[steps].path));
    }
    let others: Vec<&str> =
        unit.passes.iter().map(|p| plan.passes[*p].path.as_str()).filter(|p| *p != pass.path).collect();
    said.push(match others.as_slice() {
        [] => format!("by itself, as unit u{}", pass.unit),
        others => format!(
            "together, as unit u{}, with {}: they write what it writes, or read what is written again behind them",
            pass.unit,
            some(others)
        ),
    });
    said
}

/// The first of many names.
fn some(names: &[&str]) -> String {
    const SHOWN: usize = 8;
    let shown = names[..names.len().min(SHOWN)].join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// What makes a unit run, and by which way it comes.
fn why(plan: &Plan, unit: usize) -> Vec<String> {
    let mut said = Vec::new();
    if !plan.units[unit].own.is_empty() {
        said.push(format!("itself: {}", causes(&plan.units[unit].own)));
    }
    for (from, upstream) in plan.units.iter().enumerate().filter(|(_, upstream)| upstream.readers.contains(&unit)) {
        let Some(first) = upstream.passes.first().map(|p| &plan.passes[*p]) else { continue };
        let only_steps = upstream.passes.iter().all(|p| plan.passes[*p].steps.is_some());
        let what = if only_steps { "a step of it ran".to_owned() } else { causes(&upstream.causes) };
        said.push(format!("through u{from} ({}), which it reads from: {what}", first.path));
    }
    if said.is_empty() {
        said.push("nothing: it runs once".into());
    }
    said
}

/// With what it shares a pass of the device, or why not with what is beside it.
fn device(plan: &Plan, at: usize) -> Vec<String> {
    let handle = super::print::shared_handles(plan);
    let memory = |id: ObjectId| handle[id];
    let all = merge::shared(plan, &memory);
    let Some(shared) = all.iter().find(|shared| shared.passes.contains(&at)) else { return Vec::new() };
    let what = match shared.kind {
        SharedKind::Compute => "a compute pass",
        SharedKind::Render => "a render pass",
        SharedKind::Alone => return vec!["commands between passes, which share nothing".into()],
    };
    let mut said = match shared.passes.len() {
        1 => vec![format!("{what}, by itself")],
        _ => vec![format!("{what}, shared by passes {} to {}", shared.passes.start, shared.passes.end - 1)],
    };
    if let Some(why) = Some(at).filter(|at| *at == shared.passes.start).and_then(|at| merge::parting(plan, &memory, at))
    {
        said.push(format!("not with {}, which is before it: {why}", plan.passes[at - 1].path));
    }
    let next = Some(at + 1).filter(|next| *next == shared.passes.end && *next < plan.passes.len());
    if let Some((next, why)) = next.and_then(|next| Some((next, merge::parting(plan, &memory, next)?))) {
        said.push(format!("not with {}, which follows: {why}", plan.passes[next].path));
    }
    said
}

/// Where it runs otherwise than the program says.
fn order(plan: &Plan, at: usize) -> Vec<String> {
    let mut said: Vec<String> = (plan.order.moved.iter().filter(|moved| moved.passes.contains(&at)))
        .map(|moved| {
            let before = &plan.passes[moved.before].path;
            format!("before {before}, which the program has first: it touches nothing of it, and shares a pass so")
        })
        .collect();
    let folded = plan.order.folded.iter().filter(|folded| folded.into == plan.passes[at].path);
    said.extend(folded.map(|folded| format!("the clear {} is how it loads its target", folded.clear)));
    said
}

fn resource(plan: &Plan, sources: &Sources, id: ObjectId) -> Explanation {
    let object = &plan.objects[id];
    let touching = |wanted: &dyn Fn(&super::model::Access) -> bool| {
        let fits = |pass: &&Pass| {
            pass.accesses.iter().any(|access| wanted(access) && memory::candidates(plan, access.object).contains(&id))
        };
        let paths: Vec<&str> = plan.passes.iter().filter(fits).map(|pass| pass.path.as_str()).collect();
        if paths.is_empty() { "nothing".to_owned() } else { some(&paths) }
    };
    let facts = vec![
        ("is", vec![super::print::object(object)]),
        ("at", vec![place(sources, object.span)]),
        ("written by", vec![touching(&|access| access.write)]),
        ("read by", vec![touching(&|access| access.read)]),
        ("memory", memory::explain(plan, id)),
    ];
    Explanation { kind: "resource", path: object.path.clone(), facts }
}
