//! What is declared and not used. One plan says nothing about others, in which it may be: checking
//! compares them.

use std::collections::BTreeSet;

use super::lower::Lowering;
use super::model::{self, ObjectRef, Output, Pass};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::graph::declared::Local;
use crate::graph::model::{Graph, InputKind, NodeKind};
use crate::program::each_node;

/// Declarations that nothing asked for.
pub(super) fn unused(lowering: &Lowering<'_>) -> Diagnostics {
    let mut found = Diagnostics::new();
    let mut seen = BTreeSet::new();
    for scope in &lowering.scopes {
        let graph = &scope.graph;
        if !seen.insert(graph.path.clone()) {
            continue;
        }
        let declared = (graph.params.iter().map(|p| (&p.name, "parameter")))
            .chain(graph.lets.iter().map(|l| (&l.name, "`let`")))
            .chain(graph.samplers.iter().map(|s| (&s.name, "sampler")))
            .chain(graph.resources.iter().map(|r| (&r.name, "resource")))
            .chain(graph.inputs.iter().map(|i| (&i.name, "input")));
        for (name, what) in declared {
            if !lowering.used.contains(&name.span) && !asked_for(graph, &name.value) {
                let message = format!("nothing uses the {what} `{}`", name.value);
                found.push(Diagnostic::warning(Code::UNUSED, message).at(name.span, "declared here"));
            }
        }
        found.extend(unused_attributes(lowering, graph));
    }
    found
}

/// Whether a test of a graph names something, or a `let` asks whether it is there. `and` and `or` may
/// not have come to it, where what stands before decides.
fn asked_for(graph: &Graph, name: &str) -> bool {
    let mut is_asked = graph.lets.iter().any(|derived| derived.expr.asks_for(name));
    each_node(&graph.passes, &mut |node| {
        if let NodeKind::If(choice) = &node.kind {
            choice.test.names(&mut |path, _| is_asked |= path.split('.').next() == Some(name));
        }
    });
    is_asked
}

/// Attributes that no shader binds and no test asks for, in this graph or in a part.
fn unused_attributes(lowering: &Lowering<'_>, graph: &Graph) -> Diagnostics {
    let asked = |name: &str| {
        let mut origins = lowering.objects.iter().map(|building| &building.object.origin);
        origins.any(|o| matches!(o, model::Origin::Attribute { attribute, .. } if attribute == name))
    };
    let mut found = Diagnostics::new();
    for input in &graph.inputs {
        let InputKind::Particles { attributes } = &input.kind else { continue };
        for attribute in attributes.iter().filter(|a| !asked(&a.name.value)) {
            let message = format!("nothing uses the attribute `{}` of `{}`", attribute.name.value, input.name.value);
            found.push(Diagnostic::warning(Code::UNUSED, message).at(attribute.name.span, "asked for here"));
        }
    }
    found
}

/// Resources that nothing reads, and whether something writes them.
pub(super) fn unread(
    lowering: &Lowering<'_>,
    outputs: &[Output],
    of_stats: &[ObjectRef],
) -> Vec<(ObjectRef, bool, Diagnostic)> {
    let mut found = Vec::new();
    let mut given: BTreeSet<ObjectRef> = outputs.iter().map(|o| o.object).chain(of_stats.iter().copied()).collect();
    // What a part puts out is there for whoever wants it.
    for scope in &lowering.scopes {
        for output in &scope.graph.outputs {
            let Some(Local::Resource(i)) = scope.locals.get(&output.of.value) else { continue };
            let var = scope.resources[*i].filter(|var| *var < lowering.vars.len());
            given.extend(var.map(|var| lowering.vars[var].now));
        }
    }
    let attached: BTreeSet<ObjectRef> = lowering.flat.iter().flat_map(|f| attached(&f.pass)).collect();
    let read: BTreeSet<ObjectRef> =
        lowering.flat.iter().flat_map(|f| &f.pass.accesses).filter(|a| a.read).map(|a| a.object).collect();
    let written = written(lowering);
    for (id, building) in lowering.objects.iter().enumerate() {
        let object = ObjectRef::Fixed(id);
        let of_frame = building.object.origin == model::Origin::Frame;
        if of_frame && !attached.contains(&object) && !given.contains(&object) && !read.contains(&object) {
            let message = format!("nothing reads `{}`", building.object.path);
            let diagnostic = Diagnostic::warning(Code::NEVER_READ, message)
                .at(building.object.span, "declared here")
                .hint("put it among the `outputs`, or leave it and what writes it out");
            found.push((object, written.contains(&object), diagnostic));
        }
    }
    found
}

/// What any pass writes.
pub(super) fn written(lowering: &Lowering<'_>) -> BTreeSet<ObjectRef> {
    lowering.flat.iter().flat_map(|f| &f.pass.accesses).filter(|a| a.write).map(|a| a.object).collect()
}

/// What a draw uses without a shader that reads it: its depth target, and samples that it resolves.
fn attached(pass: &Pass) -> Vec<ObjectRef> {
    let model::PassKind::Draw(draw) = &pass.kind else { return Vec::new() };
    let resolved = draw.color.iter().filter(|target| target.resolve.is_some()).map(|target| target.view.object);
    resolved.chain(draw.depth.iter().map(|depth| depth.view.object)).collect()
}
