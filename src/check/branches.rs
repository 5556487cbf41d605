//! The branches of an `If` may give the same names: a thing that both give is of one kind, so that
//! what follows need not know which branch was taken.

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span};
use crate::format::{self, TextureFormat};
use crate::graph::model::{Graph, If, InputKind, Name, Node, NodeKind, ResourceKind, Use, ViewDimension};
use crate::program::Program;

/// What a thing is as far as its declaration says: sizes may differ from branch to branch.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Thing {
    Texture(TextureFormat, ViewDimension),
    Buffer,
    Counted,
    Scalar,
    /// Whatever feeds an input of the part: of a kind, but for `Texture`, whose format is the user's.
    Input(&'static str),
    Sampler,
}

impl Thing {
    fn name(&self) -> String {
        match self {
            Thing::Texture(format, dimension) => {
                let shape = match dimension {
                    ViewDimension::Cube | ViewDimension::CubeArray => "a cube texture",
                    ViewDimension::D3 => "a 3D texture",
                    _ => "a texture",
                };
                format!("{shape} of {}", format::name(*format))
            }
            Thing::Buffer => "a buffer".into(),
            Thing::Counted => "a counted buffer".into(),
            Thing::Scalar => "a scalar".into(),
            Thing::Input(kind) => format!("an input, {kind}"),
            Thing::Sampler => "a sampler".into(),
        }
    }
}

/// Things that two branches give under one name and that differ, in any graph of the program.
pub(super) fn differing(program: &Program) -> Diagnostics {
    let mut found = Diagnostics::new();
    for graph in program.graphs() {
        walk(program, graph, &graph.passes, &mut found);
    }
    found
}

fn walk(program: &Program, graph: &Graph, nodes: &[Node], found: &mut Diagnostics) {
    for node in nodes {
        match &node.kind {
            NodeKind::Repeat(repeat) => walk(program, graph, &repeat.passes, found),
            NodeKind::Steps(steps) => walk(program, graph, &steps.passes, found),
            NodeKind::If(choice) => {
                compare(program, graph, choice, found);
                walk(program, graph, &choice.then, found);
                walk(program, graph, &choice.otherwise, found);
            }
            _ => {}
        }
    }
}

fn compare(program: &Program, graph: &Graph, choice: &If, found: &mut Diagnostics) {
    let (then, otherwise) = (uses(&choice.then), uses(&choice.otherwise));
    for first in then {
        for second in otherwise.iter().filter(|other| other.name.value == first.name.value) {
            let parts = [first, second].map(|used| program.part(graph, &used.graph.value));
            let [Some(a), Some(b)] = parts else { continue };
            for output in &a.outputs {
                let Some(other) = b.outputs.iter().find(|o| o.name.value == output.name.value) else { continue };
                let things = (thing(program, a, &output.of.value, 0), thing(program, b, &other.of.value, 0));
                let (Some((x, at_x)), Some((y, at_y))) = things else { continue };
                if !agree(&x, &y) {
                    found.push(fault(first, second, &output.name, (&x, at_x), (&y, at_y)));
                }
            }
        }
    }
}

fn agree(a: &Thing, b: &Thing) -> bool {
    let is_texture = |thing: &Thing| matches!(thing, Thing::Texture(..) | Thing::Input("Texture"));
    let is_buffer = |thing: &Thing| matches!(thing, Thing::Buffer | Thing::Input("Buffer" | "Table"));
    let is_counted = |thing: &Thing| matches!(thing, Thing::Counted | Thing::Input("Counted"));
    let handed_on = matches!(a, Thing::Input(_)) || matches!(b, Thing::Input(_));
    a == b
        || handed_on
            && ((is_texture(a) && is_texture(b)) || (is_buffer(a) && is_buffer(b)) || (is_counted(a) && is_counted(b)))
}

fn fault(first: &Use, second: &Use, output: &Name, x: (&Thing, Span), y: (&Thing, Span)) -> Diagnostic {
    let path = format!("{}.{}", first.name.value, output.value);
    let message = format!("`{path}` is {} in one branch and {} in the other", x.0.name(), y.0.name());
    Diagnostic::error(Code::WRONG_KIND, message)
        .at(first.name.span, "one branch")
        .at(second.name.span, "the other")
        .see(x.1, x.0.name())
        .see(y.1, y.0.name())
        .hint("what both branches give under one name is of one kind and format: rename one of the uses, or its output")
}

/// Every `Use` among passes, at any depth.
fn uses(nodes: &[Node]) -> Vec<&Use> {
    let mut all = Vec::new();
    for node in nodes {
        match &node.kind {
            NodeKind::Use(used) => all.push(used),
            NodeKind::Repeat(repeat) => all.extend(uses(&repeat.passes)),
            NodeKind::Steps(steps) => all.extend(uses(&steps.passes)),
            NodeKind::If(choice) => all.extend(uses(&choice.then).into_iter().chain(uses(&choice.otherwise))),
            _ => {}
        }
    }
    all
}

/// What a path of a graph stands for, and where it is declared. `None` where that is not known here,
/// or is a fault that is told elsewhere.
fn thing(program: &Program, graph: &Graph, path: &str, depth: usize) -> Option<(Thing, Span)> {
    // Circles are told elsewhere.
    if depth > 64 {
        return None;
    }
    if let Some((head, rest)) = path.split_once('.') {
        if let Some(used) = uses(&graph.passes).into_iter().find(|used| used.name.value == head) {
            let part = program.part(graph, &used.graph.value)?;
            let output = part.outputs.iter().find(|output| output.name.value == rest)?;
            return thing(program, part, &output.of.value, depth + 1);
        }
        return None;
    }
    if let Some(resource) = graph.resources.iter().find(|r| r.name.value == path) {
        let thing = match &resource.kind {
            ResourceKind::Texture { format, dimension, .. } => Thing::Texture(format.value, *dimension),
            ResourceKind::Buffer { .. } => Thing::Buffer,
            ResourceKind::Counted { .. } => Thing::Counted,
            ResourceKind::Like(other) => thing(program, graph, &other.value, depth + 1)?.0,
        };
        return Some((thing, resource.name.span));
    }
    if let Some(input) = graph.inputs.iter().find(|i| i.name.value == path) {
        return match input.kind {
            // What feeds it counts, which is not known here.
            InputKind::Camera | InputKind::Light | InputKind::Pointer | InputKind::Particles { .. } => None,
            _ => Some((Thing::Input(input.kind.name()), input.name.span)),
        };
    }
    let scalar = (graph.params.iter().map(|p| &p.name)).chain(graph.lets.iter().map(|l| &l.name));
    if let Some(name) = scalar.into_iter().find(|name| name.value == path) {
        return Some((Thing::Scalar, name.span));
    }
    let sampler = graph.samplers.iter().find(|s| s.name.value == path)?;
    Some((Thing::Sampler, sampler.name.span))
}
