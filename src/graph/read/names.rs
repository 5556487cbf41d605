//! Which names a graph may give, and that it gives each once.

use std::collections::BTreeMap;

use super::values::is_identifier;
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::model::{Graph, Name, Node, NodeKind};
use crate::syntax::Decoder;

/// Samplers that every graph has.
pub const SAMPLERS: &[&str] =
    &["linear_clamp", "linear_repeat", "linear_mirror", "nearest_clamp", "nearest_repeat", "depth_compare"];

/// Scalars that every graph has.
pub const SCALARS: &[&str] = &["time", "delta", "frame", "step", "viewport"];

const OPERATORS: &[&str] = &["and", "or", "not"];

/// What stands against a name, with the remedy.
fn objection(name: &str) -> Option<(String, &'static str)> {
    let legal = "a name has letters, digits and `_`, does not begin with a digit, and is not `_` alone";
    if name.is_empty() {
        return Some(("a name has at least one letter".into(), legal));
    }
    if !is_identifier(name) || name == "_" {
        return Some(("it is not an identifier".into(), legal));
    }
    if name.starts_with("__") {
        return Some(("WGSL keeps names that begin with two underscores to itself".into(), "begin with a letter"));
    }
    if naga::keywords::wgsl::RESERVED.contains(&name) {
        return Some(("it is a reserved word of WGSL".into(), "choose another name"));
    }
    if SAMPLERS.contains(&name) {
        return Some(("every graph has a sampler of that name".into(), "choose another name"));
    }
    if SCALARS.contains(&name) {
        return Some(("every graph has a scalar of that name".into(), "choose another name"));
    }
    OPERATORS.contains(&name).then(|| ("it is an operator of expressions".into(), "choose another name"))
}

/// Reports a name that may not be given.
fn check_name(d: &mut Decoder<'_>, name: &Name, what: &str) {
    if let Some((why, remedy)) = objection(&name.value) {
        let message = format!("{what} cannot be called `{}`: {why}", name.value);
        d.push(Diagnostic::error(Code::BAD_NAME, message).at(name.span, "this name").hint(remedy));
    }
}

pub(super) fn duplicate(what: &str, name: &Name, first: Span) -> Diagnostic {
    Diagnostic::error(Code::DUPLICATE, format!("{what} `{}` is given twice", name.value))
        .at(name.span, "given again here")
        .see(first, "first given here")
        .hint("keep one of them")
}

/// Names that are taken, with what takes them.
type Taken = BTreeMap<String, (Span, &'static str)>;

/// Checks every name that a graph gives, and that no two things share one.
pub(super) fn check(d: &mut Decoder<'_>, graph: &Graph) {
    let mut taken = Taken::new();
    for input in &graph.inputs {
        give(d, &mut taken, &input.name, "an input");
    }
    for param in &graph.params {
        give(d, &mut taken, &param.name, "a parameter");
    }
    for binding in &graph.lets {
        give(d, &mut taken, &binding.name, "a `let`");
    }
    for resource in &graph.resources {
        give(d, &mut taken, &resource.name, if resource.state { "a state" } else { "a resource" });
    }
    for sampler in &graph.samplers {
        give(d, &mut taken, &sampler.name, "a sampler");
    }
    for output in &graph.outputs {
        // Outputs that are listed are names of things, judged elsewhere.
        if output.name.span != output.of.span {
            check_name(d, &output.name, "an output");
        }
    }
    for stat in &graph.stats {
        check_name(d, &stat.name, "a statistic");
    }
    walk(d, &graph.passes, &mut taken, &[]);
}

fn give(d: &mut Decoder<'_>, taken: &mut Taken, name: &Name, what: &'static str) {
    check_name(d, name, what);
    match taken.get(&name.value) {
        Some((first, other)) => {
            let message = format!("`{}` is the name of {other} already", name.value);
            let diagnostic = Diagnostic::error(Code::DUPLICATE, message)
                .at(name.span, format!("{what} of the same name"))
                .see(*first, format!("{other} has it"))
                .hint("inputs, parameters, `let`, resources, state, samplers and uses share one namespace: rename one");
            d.push(diagnostic);
        }
        None => _ = taken.insert(name.value.clone(), (name.span, what)),
    }
}

/// Names of uses, and loop counters; the two branches of an `If` may give the same ones.
fn walk(d: &mut Decoder<'_>, nodes: &[Node], taken: &mut Taken, counters: &[&Name]) {
    for node in nodes {
        match &node.kind {
            NodeKind::Use(part) if part.name.span == part.graph.span => {
                give(d, taken, &part.name, "a use without a `name`")
            }
            NodeKind::Use(part) => give(d, taken, &part.name, "a use"),
            NodeKind::Repeat(repeat) => {
                let mut counters = counters.to_vec();
                if let Some(index) = &repeat.index {
                    check_name(d, index, "a loop's counter");
                    if let Some(outer) = counters.iter().find(|c| c.value == index.value) {
                        d.push(duplicate("the counter", index, outer.span));
                    } else if let Some((first, what)) = taken.get(&index.value) {
                        let message = format!("`{}` is the name of {what} already", index.value);
                        d.push(
                            Diagnostic::error(Code::DUPLICATE, message)
                                .at(index.span, "a counter of the same name")
                                .see(*first, format!("{what} has it"))
                                .hint("rename the counter"),
                        );
                    }
                    counters.push(index);
                }
                walk(d, &repeat.passes, taken, &counters);
            }
            NodeKind::If(branch) => {
                let mut otherwise = taken.clone();
                walk(d, &branch.then, taken, counters);
                walk(d, &branch.otherwise, &mut otherwise, counters);
                for (name, place) in otherwise {
                    taken.entry(name).or_insert(place);
                }
            }
            NodeKind::Steps(steps) => walk(d, &steps.passes, taken, counters),
            NodeKind::Compute(_)
            | NodeKind::Draw(_)
            | NodeKind::Fullscreen(_)
            | NodeKind::Copy(_)
            | NodeKind::Clear(_) => {}
        }
    }
}
