//! Names that are one in WGSL, where a dot is written `_`: `near_color` and the output `color` of
//! a use `near`. Told where they are declared, whether or not a shader uses them.

use std::collections::BTreeMap;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span};
use crate::graph::model::{Graph, Name, Node, NodeKind, Use};
use crate::plan::{fields, input_fields};
use crate::program::Program;

/// What a graph's names are written as in WGSL: each spelling with the path that has it first.
#[derive(Default)]
struct Spelled(BTreeMap<String, (String, Span)>);

/// Names that meet, in any graph of the program.
pub(super) fn clashes(program: &Program) -> Diagnostics {
    let mut found = Diagnostics::new();
    for graph in program.graphs() {
        let mut spelled = Spelled::default();
        spelled.own(graph, &mut found);
        spelled.passes(program, graph, &graph.passes, &mut found);
    }
    found
}

impl Spelled {
    fn own(&mut self, graph: &Graph, found: &mut Diagnostics) {
        let names = (graph.params.iter().map(|p| &p.name))
            .chain(graph.lets.iter().map(|l| &l.name))
            .chain(graph.resources.iter().map(|r| &r.name))
            .chain(graph.samplers.iter().map(|s| &s.name))
            .chain(graph.inputs.iter().map(|i| &i.name));
        for name in names {
            self.give(name.value.clone(), name.span, found);
        }
        for input in &graph.inputs {
            for field in input_fields(&input.kind) {
                self.give(format!("{}.{field}", input.name.value), input.name.span, found);
            }
        }
    }

    fn passes(&mut self, program: &Program, graph: &Graph, nodes: &[Node], found: &mut Diagnostics) {
        for node in nodes {
            match &node.kind {
                NodeKind::Use(used) => self.part(program, graph, used, found),
                NodeKind::Repeat(repeat) => {
                    if let Some(Name { value, span }) = &repeat.index {
                        self.give(value.clone(), *span, found);
                    }
                    self.passes(program, graph, &repeat.passes, found);
                }
                NodeKind::If(choice) => {
                    self.passes(program, graph, &choice.then, found);
                    self.passes(program, graph, &choice.otherwise, found);
                }
                NodeKind::Steps(steps) => self.passes(program, graph, &steps.passes, found),
                _ => {}
            }
        }
    }

    fn part(&mut self, program: &Program, graph: &Graph, used: &Use, found: &mut Diagnostics) {
        self.give(used.name.value.clone(), used.name.span, found);
        let Some(part) = program.part(graph, &used.graph.value) else { return };
        for output in &part.outputs {
            self.give(format!("{}.{}", used.name.value, output.name.value), used.name.span, found);
        }
    }

    /// Loops may bear one counter's name, and branches one part's: only other paths clash.
    fn give(&mut self, path: String, at: Span, found: &mut Diagnostics) {
        let spelling = path.replace('.', "_");
        if fields::SAMPLERS.contains(&spelling.as_str()) && path != spelling {
            let message = format!("`{path}` is `{spelling}` in WGSL, and every graph has a sampler of that name");
            found.push(Diagnostic::error(Code::NAME_CLASH, message).at(at, "this name").hint("rename it"));
            return;
        }
        match self.0.get(&spelling) {
            Some((first, _)) if *first == path => {}
            // Two outputs of one part clash in the part already.
            Some((first, _)) if is_of_one_part(first, &path) => {}
            Some((first, see)) => {
                let message =
                    format!("`{first}` and `{path}` are both `{spelling}` in WGSL, which writes a dot as `_`");
                let diagnostic = Diagnostic::error(Code::NAME_CLASH, message)
                    .at(at, format!("`{path}`"))
                    .see(*see, format!("`{first}`"))
                    .hint("rename one of them");
                found.push(diagnostic);
            }
            None => _ = self.0.insert(spelling, (path, at)),
        }
    }
}

fn is_of_one_part(a: &str, b: &str) -> bool {
    let head = |path: &str| path.split_once('.').map(|(head, _)| head.to_owned());
    head(a).is_some() && head(a) == head(b)
}
