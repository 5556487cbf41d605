//! What a name stands for: in the graph language, and in WGSL where a dot is `_`.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::inputs::input_fields;
use super::swaps::{extent, same_extent};
use super::{LetState, Lowering, Result, Scalar, Scope, ScopeId, VarId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::expr::{Expr, ExprKind};
use crate::graph::model::{Graph, InputKind, Name, Node, NodeKind, Use};
use crate::graph::value::Value;
use crate::plan::fields;
use crate::plan::model::Causes;

/// How many names may lead to one another: parts in parts, and `let` names of `let` names.
const MAX_DEPTH: usize = 64;

/// What a name of a graph file declares.
#[derive(Clone, Debug)]
pub(in crate::plan) enum Local {
    Input(usize),
    Param(usize),
    Let(usize),
    Resource(usize),
    Sampler(usize),
    /// The uses of this name (several only in branches), with the tests around each.
    Use(Arc<Vec<(Use, Vec<Test>)>>),
}

/// What a path stands for.
#[derive(Clone, Debug)]
pub(in crate::plan) enum Entity {
    Scalar(Scalar),
    Var(VarId),
    /// An input that is no memory of its own, by its name in the root.
    Input {
        root: String,
        kind: InputKind,
    },
    /// An optional input, or an attribute of one, that nothing feeds.
    Absent,
    Part,
    Sampler {
        scope: ScopeId,
        index: usize,
    },
    StandardSampler(&'static str),
}

impl Entity {
    pub fn what(&self) -> &'static str {
        match self {
            Entity::Scalar(_) => "a scalar",
            Entity::Var(_) => "a texture or buffer",
            Entity::Input { kind, .. } => match kind {
                InputKind::Camera => "a camera",
                InputKind::Light => "a light",
                InputKind::Pointer => "a pointer",
                InputKind::Particles { .. } => "particles",
                InputKind::Meshes { .. } => "meshes",
                _ => "an input",
            },
            Entity::Absent => "an optional input that is absent",
            Entity::Part => "a part",
            Entity::Sampler { .. } | Entity::StandardSampler(_) => "a sampler",
        }
    }
}

impl Lowering<'_> {
    pub(super) fn add_scope(
        &mut self,
        graph: Arc<Graph>,
        path: String,
        parent: Option<ScopeId>,
        trace: Vec<Span>,
    ) -> ScopeId {
        let scope = Scope {
            locals: locals(&graph),
            dotted: HashMap::new(),
            path,
            parent,
            trace,
            binds: BTreeMap::new(),
            given: BTreeMap::new(),
            counters: Vec::new(),
            given_counts: false,
            children: BTreeMap::new(),
            resources: vec![None; graph.resources.len()],
            broken: false,
            lets: vec![LetState::Waiting; graph.lets.len()],
            graph,
        };
        self.scopes.push(scope);
        self.scopes.len() - 1
    }

    /// What `path` stands for in a graph instance.
    pub fn resolve(&mut self, s: ScopeId, path: &str, span: Span) -> Result<Entity> {
        if self.depth > MAX_DEPTH {
            let message = format!("`{path}` leads to itself: an input of a part is fed by what the part makes of it");
            return Err(traced(fault(Code::CYCLE, message, span, "part of the circle"), &self.scopes[s].trace));
        }
        self.depth += 1;
        let entity = self.resolve_here(s, path, span);
        self.depth -= 1;
        entity
    }

    fn resolve_here(&mut self, s: ScopeId, path: &str, span: Span) -> Result<Entity> {
        if let Some((_, value)) = self.scopes[s].counters.iter().rev().find(|(name, _)| name == path) {
            let counter = Scalar::known(Value::Int(*value));
            self.saw_counter = true;
            return Ok(Entity::Scalar(counter));
        }
        if let Some(builtin) = self.builtin(path, span) {
            return Ok(Entity::Scalar(builtin));
        }
        if let Some(sampler) = fields::SAMPLERS.iter().find(|name| **name == path) {
            return Ok(Entity::StandardSampler(sampler));
        }
        let (head, rest) = path.split_once('.').map_or((path, None), |(head, rest)| (head, Some(rest)));
        let Some(local) = self.scopes[s].locals.get(head).cloned() else {
            return Err(self.unknown(s, path, span));
        };
        match (local, rest) {
            (Local::Input(i), rest) => self.input(s, i, rest, span),
            (Local::Use(_), None) => {
                self.child(s, head, span)?;
                Ok(Entity::Part)
            }
            (Local::Use(_), Some(output)) => self.output(s, head, output, span),
            (Local::Param(i), None) => Ok(Entity::Scalar(self.param(s, i)?)),
            (Local::Let(i), None) => Ok(Entity::Scalar(self.let_value(s, i)?)),
            (Local::Resource(i), None) => Ok(Entity::Var(self.resource(s, i)?)),
            (Local::Sampler(i), None) => {
                self.used.insert(self.scopes[s].graph.samplers[i].name.span);
                Ok(Entity::Sampler { scope: s, index: i })
            }
            (_, Some(_)) => Err(self.unknown(s, path, span)),
        }
    }

    /// What a WGSL variable or member of this name stands for, with its path in the graph.
    pub fn resolve_wgsl(&mut self, s: ScopeId, name: &str, span: Span) -> Result<Option<(String, Entity)>> {
        let mut found: Vec<String> = Vec::new();
        if self.is_local(s, name) {
            found.push(name.to_owned());
        }
        found.extend(self.dotted(s, name, span)?.iter().cloned());
        match found.len() {
            0 => Ok(None),
            1 => {
                let path = found.remove(0);
                let entity = self.resolve(s, &path, span)?;
                Ok(Some((path, entity)))
            }
            _ => {
                let message = format!("`{name}` could be {}: a dot is written `_` in WGSL", list(&found));
                let mut diagnostic = fault(Code::NAME_CLASH, message, span, "this WGSL name");
                for path in &found {
                    let head = path.split('.').next().unwrap_or(path);
                    if let Some(declared) = self.declared(s, head) {
                        diagnostic = diagnostic.see(declared, format!("`{path}`"));
                    }
                }
                let diagnostic = diagnostic.hint("rename one of them, or say which with `bind`");
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
        }
    }

    /// The paths of two names and a dot that a WGSL name could be. Asked for at each pass of a loop.
    fn dotted(&mut self, s: ScopeId, name: &str, span: Span) -> Result<Arc<[String]>> {
        if let Some(known) = self.scopes[s].dotted.get(name) {
            return Ok(known.clone());
        }
        let mut found = Vec::new();
        for (at, _) in name.match_indices('_') {
            let (head, rest) = (&name[..at], &name[at + 1..]);
            let Some(local) = self.scopes[s].locals.get(head).cloned() else { continue };
            match local {
                Local::Use(_) => {
                    let child = self.child(s, head, span)?;
                    let outputs = &self.scopes[child].graph.outputs;
                    let matching = outputs.iter().filter(|o| o.name.value.replace('.', "_") == rest);
                    found.extend(matching.map(|o| format!("{head}.{}", o.name.value)));
                }
                Local::Input(i) => {
                    let kind = &self.scopes[s].graph.inputs[i].kind;
                    if input_fields(kind).any(|field| field == rest) {
                        found.push(format!("{head}.{rest}"));
                    }
                }
                _ => {}
            }
        }
        let found: Arc<[String]> = found.into();
        self.scopes[s].dotted.insert(name.to_owned(), found.clone());
        Ok(found)
    }

    /// Where a name of the graph is declared.
    fn declared(&self, s: ScopeId, name: &str) -> Option<Span> {
        let graph = &self.scopes[s].graph;
        match self.scopes[s].locals.get(name)? {
            Local::Input(i) => Some(graph.inputs[*i].name.span),
            Local::Param(i) => Some(graph.params[*i].name.span),
            Local::Let(i) => Some(graph.lets[*i].name.span),
            Local::Resource(i) => Some(graph.resources[*i].name.span),
            Local::Sampler(i) => Some(graph.samplers[*i].name.span),
            Local::Use(candidates) => candidates.first().map(|(used, _)| used.name.span),
        }
    }

    /// Whether a path may be followed by a dot and a name: an input's or a part's.
    pub(super) fn has_fields(&self, s: ScopeId, path: &str) -> bool {
        match self.scopes[s].locals.get(path.split('.').next().unwrap_or(path)) {
            Some(Local::Use(_)) => true,
            Some(Local::Input(_)) => !path.contains('.'),
            _ => false,
        }
    }

    fn is_local(&self, s: ScopeId, name: &str) -> bool {
        let scope = &self.scopes[s];
        scope.locals.contains_key(name)
            || scope.counters.iter().any(|(counter, _)| counter == name)
            || name == "viewport"
            || fields::FRAME.iter().any(|(field, _)| *field == name)
            || fields::SAMPLERS.contains(&name)
    }

    fn builtin(&self, path: &str, span: Span) -> Option<Scalar> {
        if path == "viewport" {
            let [w, h] = self.request.viewport;
            let value = Value::ints([w, h].map(i64::from));
            let causes = Causes { viewport: true, ..Causes::default() };
            return Some(Scalar::caused(value, causes));
        }
        fields::FRAME.iter().find(|(name, _)| *name == path).map(|(name, _)| live(name, span))
    }

    /// The names that a graph instance can say, for "did you mean".
    pub fn visible(&self, s: ScopeId) -> Vec<String> {
        let scope = &self.scopes[s];
        let mut names: Vec<String> = scope.locals.keys().cloned().collect();
        for input in &scope.graph.inputs {
            names.extend(input_fields(&input.kind).map(|field| format!("{}.{field}", input.name.value)));
        }
        for (name, child) in &scope.children {
            let outputs = &self.scopes[*child].graph.outputs;
            names.extend(outputs.iter().map(|output| format!("{name}.{}", output.name.value)));
        }
        names.extend(fields::FRAME.iter().map(|(name, _)| (*name).to_owned()));
        names.push("viewport".to_owned());
        names.extend(scope.counters.iter().map(|(name, _)| name.clone()));
        names.sort();
        names
    }

    pub(super) fn unknown(&self, s: ScopeId, path: &str, span: Span) -> Box<Diagnostic> {
        let names = self.visible(s);
        let diagnostic = fault(Code::UNKNOWN_NAME, format!("nothing is called `{path}`"), span, "unknown name")
            .nearest(path, names.iter().map(String::as_str));
        traced(diagnostic, &self.scopes[s].trace)
    }

    fn output(&mut self, s: ScopeId, name: &str, output: &str, span: Span) -> Result<Entity> {
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
                let path = join(&self.scopes[s].path, &used.name.value);
                let mut trace = self.scopes[s].trace.clone();
                trace.push(used.name.span);
                let child = self.add_scope(graph.clone(), path, Some(s), trace);
                self.scopes[child].binds = self.binds(&graph, used);
                self.scopes[s].children.insert(used.name.value.clone(), child);
                self.give(s, child, used);
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

/// Something that is known only while a frame runs.
pub(super) fn live(name: &str, span: Span) -> Scalar {
    let causes = Causes { live: [name.to_owned()].into(), ..Causes::default() };
    Scalar::live(Expr { kind: ExprKind::Name(name.to_owned()), span }, causes)
}

pub(super) fn join(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

/// `a`, `b` and `c`, in backquotes.
pub(in crate::plan) fn list(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
    match quoted.as_slice() {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

fn locals(graph: &Graph) -> HashMap<String, Local> {
    let mut locals = HashMap::new();
    for (i, input) in graph.inputs.iter().enumerate() {
        locals.insert(input.name.value.clone(), Local::Input(i));
    }
    for (i, param) in graph.params.iter().enumerate() {
        locals.insert(param.name.value.clone(), Local::Param(i));
    }
    for (i, derived) in graph.lets.iter().enumerate() {
        locals.insert(derived.name.value.clone(), Local::Let(i));
    }
    for (i, resource) in graph.resources.iter().enumerate() {
        locals.insert(resource.name.value.clone(), Local::Resource(i));
    }
    for (i, sampler) in graph.samplers.iter().enumerate() {
        locals.insert(sampler.name.value.clone(), Local::Sampler(i));
    }
    uses(&graph.passes, &mut Vec::new(), &mut |used, tests| {
        let local = locals.entry(used.name.value.clone()).or_insert_with(|| Local::Use(Arc::default()));
        if let Local::Use(candidates) = local {
            Arc::make_mut(candidates).push((used.clone(), tests.to_vec()));
        }
    });
    locals
}

/// A test of an `If`, and the outcome that takes the branch.
type Test = (Expr, bool);

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

/// `its inputs are a and b`.
fn inputs_of(graph: &Graph) -> String {
    let names: Vec<String> = graph.inputs.iter().map(|i| i.name.value.clone()).collect();
    match names.as_slice() {
        [] => "it has no inputs".to_owned(),
        names => format!("its inputs are {}", list(names)),
    }
}
