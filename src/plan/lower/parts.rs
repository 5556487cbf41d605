//! Instances of parts: made when something first asks for them, and given their parameters.

use std::collections::BTreeMap;

use super::names::{Entity, join, list};
use super::swaps::{extent, same_extent};
use super::{LetState, Lowering, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::declared::Local;
use crate::graph::model::{Graph, Name, Use};

impl Lowering<'_> {
    pub(super) fn output(&mut self, s: ScopeId, name: &str, output: &str, span: Span) -> Result<Entity> {
        let child = self.child(s, name, span)?;
        let graph = self.scopes[child].graph.clone();
        match graph.outputs.iter().find(|o| o.name.value == output) {
            Some(found) => self.resolve(child, &found.of.value, found.of.span),
            None => {
                let names: Vec<String> = graph.outputs.iter().map(|o| o.name.value.clone()).collect();
                let message = format!("`{name}` has no output `{output}`");
                let diagnostic = fault(Code::UNKNOWN_NAME, message, span, "unknown output")
                    .see(graph.span, format!("its outputs are {}", list(&names)))
                    .nearest(output, names.iter().map(String::as_str));
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
        }
    }

    /// The instance of a part that is used under this name. Made when first asked for.
    pub(super) fn child(&mut self, s: ScopeId, name: &str, span: Span) -> Result<ScopeId> {
        if let Some(child) = self.scopes[s].children.get(name) {
            return Ok(*child);
        }
        let Some(Local::Use(candidates)) = self.scopes[s].locals.get(name).cloned() else {
            return Err(self.unknown(s, name, span));
        };
        for (used, tests) in candidates.iter() {
            let mut taken = true;
            for (test, wanted) in tests {
                taken &= self.boolean(s, test)?.0 == *wanted;
            }
            if taken {
                return self.enter(s, used);
            }
        }
        let message = format!("`{name}` is not there: the branch that uses it is not taken");
        let mut diagnostic = fault(Code::UNKNOWN_NAME, message, span, "needs the part");
        for (used, _) in candidates.iter() {
            diagnostic = diagnostic.see(used.name.span, "used only in a branch");
        }
        let diagnostic = diagnostic.hint("put what needs the part into the same branch, or use a part in both");
        Err(traced(diagnostic, &self.scopes[s].trace))
    }

    /// Makes or revisits the instance of a `Use`, with the parameters that it gives now.
    pub(super) fn enter(&mut self, s: ScopeId, used: &Use) -> Result<ScopeId> {
        let parent = self.scopes[s].graph.clone();
        let Some(graph) = self.program.part(&parent, &used.graph.value).cloned() else {
            let message = format!("the part `{}` was not read", used.graph.value);
            return Err(Box::new(fault(Code::FILE_MISSING, message, used.graph.span, "named here")));
        };
        let child = match self.scopes[s].children.get(&used.name.value) {
            Some(child) => *child,
            None => {
                self.unroll(s, used.name.span)?;
                // What it is given first is nothing new to anybody.
                let given_anew = self.given_anew;
                let path = join(&self.scopes[s].path, &used.name.value);
                let mut trace = self.scopes[s].trace.clone();
                trace.push(used.name.span);
                let child = self.add_scope(graph.clone(), path, Some(s), trace);
                self.scopes[child].binds = self.binds(&graph, used);
                self.scopes[s].children.insert(used.name.value.clone(), child);
                self.give(s, child, used);
                self.given_anew = given_anew;
                self.scopes[child].broken = !self.check_inputs(child);
                self.declare_params(child);
                return Ok(child);
            }
        };
        self.give(s, child, used);
        Ok(child)
    }

    fn binds(&mut self, graph: &Graph, used: &Use) -> BTreeMap<String, Name> {
        let mut binds = BTreeMap::new();
        for (input, outside) in &used.bind {
            if graph.inputs.iter().any(|i| i.name.value == input.value) {
                binds.insert(input.value.clone(), outside.clone());
            } else {
                let message = format!("the part `{}` has no input `{}`", used.graph.value, input.value);
                let names: Vec<&str> = graph.inputs.iter().map(|i| i.name.value.as_str()).collect();
                self.diagnostics.push(
                    fault(Code::UNKNOWN_NAME, message, input.span, "unknown input")
                        .see(graph.span, inputs_of(graph))
                        .nearest(&input.value, names),
                );
            }
        }
        binds
    }

    /// Evaluates the parameters that a `Use` gives. In a loop they may change from one iteration
    /// to the next, so what depends on them is forgotten.
    fn give(&mut self, s: ScopeId, child: ScopeId, used: &Use) {
        let graph = self.scopes[child].graph.clone();
        let mut given = BTreeMap::new();
        let saw_counter = std::mem::take(&mut self.saw_counter);
        for (name, expr) in &used.params {
            let Some(param) = graph.params.iter().find(|p| p.name.value == name.value) else {
                let message = format!("the part `{}` has no parameter `{}`", used.graph.value, name.value);
                let names: Vec<&str> = graph.params.iter().map(|p| p.name.value.as_str()).collect();
                self.diagnostics.push(
                    fault(Code::UNKNOWN_NAME, message, name.span, "unknown parameter")
                        .see(graph.span, "the part")
                        .nearest(&name.value, names),
                );
                continue;
            };
            let result = self.scalar(s, expr).and_then(|scalar| {
                self.fit(scalar, param, expr.span).map_err(|fault| traced(*fault, &self.scopes[s].trace))
            });
            if let Some(scalar) = self.report(result) {
                given.insert(name.value.clone(), (scalar, expr.span));
            }
        }
        let given_counts = std::mem::replace(&mut self.saw_counter, saw_counter);
        let scope = &mut self.scopes[child];
        scope.given_counts = given_counts;
        if scope.given != given {
            scope.given = given;
            self.given_anew += 1;
            scope.lets = vec![LetState::Waiting; scope.graph.lets.len()];
            // What the part's own parts were given may depend on it; they are entered anew in
            // program order, here only what is asked for before that is forgotten.
            self.check_still_fits(child, used);
        }
    }

    /// Resources have one size in a frame: what a part is given anew must not make them others.
    fn check_still_fits(&mut self, s: ScopeId, used: &Use) {
        let graph = self.scopes[s].graph.clone();
        for (i, resource) in graph.resources.iter().enumerate() {
            let Some(var) = self.scopes[s].resources[i].filter(|var| *var < self.vars.len()) else { continue };
            let result = self.describe_anew(s, i);
            let Some(now) = self.report(result) else { continue };
            let before = self.vars[var].now;
            if same_extent(&self.object(before).object.kind, &now) {
                continue;
            }
            let name = &resource.name.value;
            let message = format!("`{}.{name}` would have another size in each iteration", used.name.value);
            let at = used.params.first().map_or(used.name.span, |(_, expr)| expr.span);
            let diagnostic = fault(Code::BAD_PARAMETER, message, at, format!("now it is{}", extent(&now)))
                .see(resource.name.span, format!("it was{}", extent(&self.object(before).object.kind)))
                .hint("a resource has one size in a frame: give it the largest, and let what is given say how much of it counts")
                .hint("or use the part once for each size, under names of their own");
            let diagnostic = *traced(diagnostic, &self.scopes[s].trace);
            if !self.diagnostics.iter().any(|known| known.message == diagnostic.message) {
                self.diagnostics.push(diagnostic);
            }
        }
    }
}

/// `its inputs are a and b`.
fn inputs_of(graph: &Graph) -> String {
    let names: Vec<String> = graph.inputs.iter().map(|i| i.name.value.clone()).collect();
    match names.as_slice() {
        [] => "it has no inputs".to_owned(),
        names => format!("its inputs are {}", list(names)),
    }
}
