//! What the names of a graph file declare: worked out once, when the file is read, and asked for
//! at every name that planning meets.

use std::sync::Arc;

use super::expr::Expr;
use super::model::{Graph, Node, NodeKind, Use};
use crate::words::Words;

/// What a name of a graph file declares.
#[derive(Clone, Debug)]
pub enum Local {
    Input(usize),
    Param(usize),
    Let(usize),
    Resource(usize),
    Sampler(usize),
    /// The uses of this name (several only in branches), with the tests around each.
    Use(Arc<Vec<(Use, Vec<Test>)>>),
}

/// A test of an `If`, and the outcome that takes the branch.
pub type Test = (Expr, bool);

/// Everything that a graph file declares, by name.
pub fn declared(graph: &Graph) -> Words<Local> {
    let mut locals = Words::default();
    let mut all = |name: &str, local| _ = locals.insert(name.to_owned(), local);
    graph.inputs.iter().enumerate().for_each(|(i, input)| all(&input.name.value, Local::Input(i)));
    graph.params.iter().enumerate().for_each(|(i, param)| all(&param.name.value, Local::Param(i)));
    graph.lets.iter().enumerate().for_each(|(i, derived)| all(&derived.name.value, Local::Let(i)));
    graph.resources.iter().enumerate().for_each(|(i, resource)| all(&resource.name.value, Local::Resource(i)));
    graph.samplers.iter().enumerate().for_each(|(i, sampler)| all(&sampler.name.value, Local::Sampler(i)));
    uses(&graph.passes, &mut Vec::new(), &mut |used, tests| {
        let local = locals.entry(used.name.value.clone()).or_insert_with(|| Local::Use(Arc::default()));
        if let Local::Use(candidates) = local {
            Arc::make_mut(candidates).push((used.clone(), tests.to_vec()));
        }
    });
    locals
}

/// Visits every `Use` with the tests that must hold for it to be taken.
fn uses(nodes: &[Node], tests: &mut Vec<Test>, visit: &mut dyn FnMut(&Use, &[Test])) {
    for node in nodes {
        match &node.kind {
            NodeKind::Use(used) => visit(used, tests),
            NodeKind::Repeat(repeat) => uses(&repeat.passes, tests, visit),
            NodeKind::Steps(steps) => uses(&steps.passes, tests, visit),
            NodeKind::If(choice) => {
                for (branch, wanted) in [(&choice.then, true), (&choice.otherwise, false)] {
                    tests.push((choice.test.clone(), wanted));
                    uses(branch, tests, visit);
                    tests.pop();
                }
            }
            _ => {}
        }
    }
}
