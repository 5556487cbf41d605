//! What a name in WGSL stands for, where a dot is written `_`.

use std::sync::Arc;

use super::inputs::input_fields;
use super::names::{Entity, list};
use super::{Lowering, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::declared::Local;
use crate::plan::fields;

impl Lowering<'_> {
    /// What a WGSL variable or member of this name stands for, with its path in the graph.
    pub fn resolve_wgsl(&mut self, s: ScopeId, name: &str, span: Span) -> Result<Option<(Arc<str>, Entity)>> {
        let mut paths = self.spelled(s, name, span)?;
        let is_counter = self.scopes[s].counters.iter().any(|(counter, _)| counter == name);
        if is_counter && paths.first().is_none_or(|path| &**path != name) {
            paths = std::iter::once(name.into()).chain(paths.iter().cloned()).collect();
        }
        match &*paths {
            [] => Ok(None),
            [path] => Ok(Some((path.clone(), self.resolve(s, path, span)?))),
            paths => Err(self.unclear(s, name, paths, span)),
        }
    }

    fn unclear(&self, s: ScopeId, name: &str, paths: &[Arc<str>], span: Span) -> Box<Diagnostic> {
        let shown: Vec<String> = paths.iter().map(|path| path.to_string()).collect();
        let message = format!("`{name}` could be {}: a dot is written `_` in WGSL", list(&shown));
        let mut diagnostic = fault(Code::NAME_CLASH, message, span, "this WGSL name");
        for path in paths {
            let head = path.split('.').next().unwrap_or(path);
            if let Some(declared) = self.declared(s, head) {
                diagnostic = diagnostic.see(declared, format!("`{path}`"));
            }
        }
        traced(diagnostic.hint("rename one of them, or say which with `bind`"), &self.scopes[s].trace)
    }

    /// The paths that a WGSL name could be, but for counters of loops: itself, and two names and a
    /// dot. Asked for at each pass of a loop.
    fn spelled(&mut self, s: ScopeId, name: &str, span: Span) -> Result<Arc<[Arc<str>]>> {
        if let Some(known) = self.scopes[s].spelled.get(name) {
            return Ok(known.clone());
        }
        let mut found: Vec<Arc<str>> = Vec::new();
        if self.is_there(s, name) {
            found.push(name.into());
        }
        for (at, _) in name.match_indices('_') {
            let (head, rest) = (&name[..at], &name[at + 1..]);
            let Some(local) = self.scopes[s].locals.get(head).cloned() else { continue };
            match local {
                Local::Use(_) => {
                    let child = self.child(s, head, span)?;
                    let outputs = &self.scopes[child].graph.outputs;
                    let matching = outputs.iter().filter(|o| o.name.value.replace('.', "_") == rest);
                    found.extend(matching.map(|o| format!("{head}.{}", o.name.value).into()));
                }
                Local::Input(i) => {
                    let kind = &self.scopes[s].graph.inputs[i].kind;
                    if input_fields(kind).any(|field| field == rest) {
                        found.push(format!("{head}.{rest}").into());
                    }
                }
                _ => {}
            }
        }
        let found: Arc<[Arc<str>]> = found.into();
        self.scopes[s].spelled.insert(name.to_owned(), found.clone());
        Ok(found)
    }

    /// Whether a name is declared, or one that every graph has.
    fn is_there(&self, s: ScopeId, name: &str) -> bool {
        self.scopes[s].locals.contains_key(name)
            || name == "viewport"
            || fields::FRAME.iter().any(|(field, _)| *field == name)
            || fields::SAMPLERS.contains(&name)
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
}
