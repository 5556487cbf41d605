//! What a name of the graph language stands for.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::inputs::input_fields;
use super::{CauseKind, LetState, Lowering, Result, Scalar, Scope, ScopeId, VarId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::declared::Local;
use crate::graph::expr::{Expr, ExprKind};
use crate::graph::model::{Graph, InputKind};
use crate::graph::value::Value;
use crate::plan::fields;
use crate::words::Words;

/// How many names may lead to one another: parts in parts, and `let` names of `let` names.
const MAX_DEPTH: usize = 64;

/// What a path stands for.
#[derive(Clone, Debug)]
pub(in crate::plan) enum Entity {
    Scalar(Scalar),
    Var(VarId),
    /// An input that is no memory of its own, by its name in the root.
    Input {
        root: Arc<str>,
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
            locals: self.program.declared(&graph),
            spelled: Words::default(),
            packed: HashMap::default(),
            own_params: vec![None; graph.params.len()],
            fed: vec![None; graph.inputs.len()],
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
        let (head, rest) = path.split_once('.').map_or((path, None), |(head, rest)| (head, Some(rest)));
        let Some(local) = self.scopes[s].locals.get(head).cloned() else {
            return self.builtin(path, span).ok_or_else(|| self.unknown(s, path, span));
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

    /// Whether a path may be followed by a dot and a name: an input's or a part's.
    pub(super) fn has_fields(&self, s: ScopeId, path: &str) -> bool {
        match self.scopes[s].locals.get(path.split('.').next().unwrap_or(path)) {
            Some(Local::Use(_)) => true,
            Some(Local::Input(_)) => !path.contains('.'),
            _ => false,
        }
    }

    /// What every graph has. No declaration can bear these names.
    fn builtin(&mut self, path: &str, span: Span) -> Option<Entity> {
        if path == "viewport" {
            let [w, h] = self.request.viewport;
            let value = Value::ints([w, h].map(i64::from));
            let causes = self.causes.set(CauseKind::Viewport, "");
            return Some(Entity::Scalar(Scalar::caused(value, causes)));
        }
        if let Some((name, _)) = fields::FRAME.iter().find(|(name, _)| *name == path) {
            return Some(Entity::Scalar(self.live(name, span)));
        }
        fields::SAMPLERS.iter().find(|name| **name == path).map(|name| Entity::StandardSampler(name))
    }

    /// Something that is known only while a frame runs.
    pub(super) fn live(&mut self, name: &str, span: Span) -> Scalar {
        let causes = self.causes.set(CauseKind::Live, name);
        Scalar::live(Expr { kind: ExprKind::Name(name.to_owned()), span }, causes)
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
