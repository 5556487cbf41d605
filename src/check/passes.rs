//! Names of passes: each is unique in its graph.

use std::collections::BTreeMap;
use std::path::Path;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span};
use crate::graph::model::{Name, Node, NodeKind, ShaderRef};
use crate::program::Program;

/// Names that are taken, and where.
type Taken = BTreeMap<String, Span>;

/// Passes of one name in one graph, in any graph of the program.
pub(super) fn names(program: &Program) -> Diagnostics {
    let mut found = Diagnostics::new();
    for graph in program.graphs() {
        walk(&graph.passes, &mut Taken::new(), &mut found);
    }
    found
}

/// Both branches of an `If` may give the same names: only one of them is taken.
fn walk(nodes: &[Node], taken: &mut Taken, found: &mut Diagnostics) {
    for node in nodes {
        match &node.kind {
            NodeKind::Compute(pass) => give(pass.name.as_ref(), Some(&pass.shader), taken, found),
            NodeKind::Draw(pass) | NodeKind::Fullscreen(pass) => {
                give(pass.name.as_ref(), Some(&pass.shader), taken, found);
            }
            NodeKind::Copy(pass) => give(pass.name.as_ref(), None, taken, found),
            NodeKind::Clear(pass) => give(pass.name.as_ref(), None, taken, found),
            NodeKind::Repeat(repeat) => walk(&repeat.passes, taken, found),
            NodeKind::Steps(steps) => walk(&steps.passes, taken, found),
            NodeKind::If(choice) => {
                let mut otherwise = taken.clone();
                walk(&choice.then, taken, found);
                walk(&choice.otherwise, &mut otherwise, found);
                taken.extend(otherwise);
            }
            NodeKind::Use(_) => {}
        }
    }
}

fn give(name: Option<&Name>, shader: Option<&ShaderRef>, taken: &mut Taken, found: &mut Diagnostics) {
    let stem = |shader: &ShaderRef| {
        let stem = Path::new(&shader.path.value).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        (stem.unwrap_or_default(), shader.path.span)
    };
    let given = name.map(|name| (name.value.clone(), name.span)).or(shader.map(stem));
    // A `Clear` or `Copy` without a name is called by what it writes, as often as it does.
    let Some((name, at)) = given else { return };
    if let Some(first) = taken.get(&name) {
        let message = format!("two passes of this graph are called `{name}`");
        let diagnostic = Diagnostic::error(Code::DUPLICATE, message)
            .at(at, "called so again")
            .see(*first, "the first of the name")
            .hint("a pass is called as its shader if it has no `name`: give one of them `name: \"...\"`");
        found.push(diagnostic);
    } else {
        taken.insert(name, at);
    }
}
