//! A graph with everything that it names: its parts, at any depth, and all their shaders.
//!
//! Loading reads files and reports what is wrong in each of them on its own; how they fit
//! together is for planning.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, FileId, Sources, Span};
use crate::files::{self, Files, Kind, NotFound};
use crate::graph::declared::{Local, declared};
use crate::graph::expr::Expr;
use crate::graph::model::{Graph, Name, Node, NodeKind};
use crate::parallel::in_parallel;
use crate::shader::Gathered;
use crate::shader::reflect::Module;
use crate::words::Words;

/// A graph with its parts and shaders, all read without error.
#[derive(Clone, Debug)]
pub struct Program {
    pub root: Arc<Graph>,
    graphs: BTreeMap<PathBuf, Arc<Graph>>,
    shaders: BTreeMap<PathBuf, Arc<Module>>,
    links: Links,
    /// What is behind the links, and what each graph declares: planning asks for them all the time.
    linked: BTreeMap<FileId, Words<Linked>>,
    declared: BTreeMap<FileId, Arc<Words<Local>>>,
}

/// By the naming graph, by the name as written: the file that was taken.
type Links = BTreeMap<PathBuf, BTreeMap<String, PathBuf>>;

#[derive(Clone, Debug)]
enum Linked {
    Part(Arc<Graph>),
    Shader(Arc<Module>),
}

impl Program {
    fn new(
        root: Arc<Graph>,
        graphs: BTreeMap<PathBuf, Arc<Graph>>,
        shaders: BTreeMap<PathBuf, Arc<Module>>,
        links: Links,
    ) -> Self {
        let linked = |path: &PathBuf| {
            let part = graphs.get(path).map(|part| Linked::Part(part.clone()));
            part.or_else(|| shaders.get(path).map(|module| Linked::Shader(module.clone())))
        };
        let all = |links: &BTreeMap<String, PathBuf>| -> Words<Linked> {
            links.iter().filter_map(|(name, path)| Some((name.clone(), linked(path)?))).collect()
        };
        let linked = links.iter().filter_map(|(from, links)| Some((graphs.get(from)?.file, all(links)))).collect();
        let declared = graphs.values().map(|graph| (graph.file, declared(graph).into())).collect();
        Self { root, graphs, shaders, links, linked, declared }
    }

    /// The part that `graph` names so.
    pub fn part(&self, graph: &Graph, name: &str) -> Option<&Arc<Graph>> {
        match self.linked.get(&graph.file)?.get(name)? {
            Linked::Part(part) => Some(part),
            Linked::Shader(_) => None,
        }
    }

    /// The shader that `graph` names so.
    pub fn shader(&self, graph: &Graph, name: &str) -> Option<&Arc<Module>> {
        match self.linked.get(&graph.file)?.get(name)? {
            Linked::Shader(module) => Some(module),
            Linked::Part(_) => None,
        }
    }

    /// What each name of a graph of the program declares.
    pub(crate) fn declared(&self, graph: &Graph) -> Arc<Words<Local>> {
        self.declared.get(&graph.file).cloned().unwrap_or_else(|| declared(graph).into())
    }

    /// All graphs, the root among them, by file.
    pub fn graphs(&self) -> impl Iterator<Item = &Arc<Graph>> {
        self.graphs.values()
    }

    /// All shader modules by file.
    pub fn shaders(&self) -> impl Iterator<Item = &Arc<Module>> {
        self.shaders.values()
    }

    /// Whether `path` is the instance path of a parameter that a user can set, in any branch; if
    /// not, the paths that it could have been.
    pub fn has_param(&self, path: &str) -> Result<(), Vec<String>> {
        // Two branches may use two parts by one name.
        let mut instances: Vec<(&Graph, &[(Name, Expr)])> = vec![(&self.root, &[])];
        let parts: Vec<&str> = path.split('.').collect();
        let (name, uses) = parts.split_last().unwrap_or((&path, &[]));
        let mut prefix = String::new();
        for part in uses {
            let inside = self.used_as(&instances, part);
            if inside.is_empty() {
                break;
            }
            instances = inside;
            prefix = format!("{prefix}{part}.");
        }
        let mut known: Vec<String> = Vec::new();
        for (graph, given) in instances {
            let is_given = |name: &Name| given.iter().any(|(other, _)| other.value == name.value);
            let names = graph.params.iter().filter(|p| !is_given(&p.name)).map(|p| format!("{prefix}{}", p.name.value));
            known.extend(names);
        }
        let is_whole = prefix.len() + name.len() == path.len();
        if is_whole && known.iter().any(|known| known == path) { Ok(()) } else { Err(known) }
    }

    /// The parts that graphs use by a name, each with the parameters that it is given.
    fn used_as<'p>(
        &'p self,
        instances: &[(&'p Graph, &[(Name, Expr)])],
        name: &str,
    ) -> Vec<(&'p Graph, &'p [(Name, Expr)])> {
        let mut found: Vec<(&Graph, &[(Name, Expr)])> = Vec::new();
        for (graph, _) in instances {
            each_node(&graph.passes, &mut |node| {
                if let NodeKind::Use(used) = &node.kind
                    && used.name.value == name
                    && let Some(part) = self.part(graph, &used.graph.value)
                {
                    found.push((part, &used.params));
                }
            });
        }
        found
    }

    /// Each name as written and the file that was taken for it.
    pub fn taken(&self) -> BTreeMap<String, PathBuf> {
        self.links.values().flatten().map(|(name, path)| (name.clone(), path.clone())).collect()
    }
}

/// What loading gave.
#[derive(Debug)]
pub struct Loaded {
    /// Absent if anything had an error.
    pub program: Option<Program>,
    pub diagnostics: Diagnostics,
    /// Every file that was read or, where missing, looked for: what a watcher watches.
    pub read: Vec<PathBuf>,
}

/// Loads a graph file with all that it names.
pub fn load(files: &dyn Files, sources: &mut Sources, name: &str, beside: Option<&Path>) -> Loaded {
    let mut loader = Loader {
        files,
        sources,
        diagnostics: Diagnostics::new(),
        read: Vec::new(),
        graphs: BTreeMap::new(),
        shaders: BTreeMap::new(),
        links: BTreeMap::new(),
        gathered: Vec::new(),
        stack: Vec::new(),
    };
    let root = loader.find(Kind::Graph, name, beside, None).and_then(|(path, bytes)| loader.graph(path, &bytes));
    loader.parse();
    let Loader { diagnostics, mut read, graphs, shaders, links, .. } = loader;
    read.sort();
    read.dedup();
    let program = match root.and_then(|path| graphs.get(&path)?.clone()) {
        Some(root) if !diagnostics.has_errors() => {
            let graphs = graphs.into_iter().filter_map(|(path, graph)| Some((path, graph?))).collect();
            let shaders = shaders.into_iter().filter_map(|(path, module)| Some((path, module?))).collect();
            Some(Program::new(root, graphs, shaders, links))
        }
        _ => None,
    };
    Loaded { program, diagnostics, read }
}

struct Loader<'a> {
    files: &'a dyn Files,
    sources: &'a mut Sources,
    diagnostics: Diagnostics,
    read: Vec<PathBuf>,
    /// `None` for what was tried and had errors.
    graphs: BTreeMap<PathBuf, Option<Arc<Graph>>>,
    shaders: BTreeMap<PathBuf, Option<Arc<Module>>>,
    links: Links,
    /// Shaders with their imports, in the order in which they were named, still to be parsed.
    gathered: Vec<(PathBuf, Gathered)>,
    /// Graphs being read, each with the place that named it: a name that is on it is a cycle.
    stack: Vec<(PathBuf, Option<Span>)>,
}

impl Loader<'_> {
    fn find(
        &mut self,
        kind: Kind,
        name: &str,
        beside: Option<&Path>,
        at: Option<Span>,
    ) -> Option<(PathBuf, Arc<[u8]>)> {
        match files::find(self.files, kind, name, beside) {
            Ok(found) => {
                self.read.push(found.path.clone());
                Some((found.path, found.bytes))
            }
            Err(missing) => {
                self.read.extend(missing.tried.iter().cloned());
                self.diagnostics.push(missing_file(name, kind, &missing, at));
                None
            }
        }
    }

    /// Reads a graph and what it names; gives its path back.
    fn graph(&mut self, path: PathBuf, bytes: &[u8]) -> Option<PathBuf> {
        if self.graphs.contains_key(&path) {
            return Some(path);
        }
        let Some(file) = self.text(&path, bytes) else {
            self.graphs.insert(path, None);
            return None;
        };
        let (graph, diagnostics) = crate::graph::read(self.sources, file, &path);
        self.diagnostics.extend(diagnostics);
        let Some(graph) = graph.map(Arc::new) else {
            self.graphs.insert(path, None);
            return None;
        };
        self.graphs.insert(path.clone(), Some(graph.clone()));
        if self.stack.is_empty() {
            self.stack.push((path.clone(), None));
        }
        each_node(&graph.passes, &mut |node| match &node.kind {
            NodeKind::Use(u) => self.part(&graph, &u.graph),
            NodeKind::Compute(c) => self.shader(&graph, &c.shader.path),
            NodeKind::Draw(d) | NodeKind::Fullscreen(d) => self.shader(&graph, &d.shader.path),
            _ => {}
        });
        Some(path)
    }

    fn part(&mut self, graph: &Graph, name: &Name) {
        if self.links.get(&graph.path).is_some_and(|links| links.contains_key(&name.value)) {
            return;
        }
        let Some((path, bytes)) = self.find(Kind::Graph, &name.value, Some(&graph.path), Some(name.span)) else {
            return;
        };
        self.link(graph, name, &path);
        if let Some(from) = self.stack.iter().position(|(open, _)| *open == path) {
            self.diagnostics.push(include_cycle(&self.stack[from..], &path, name.span));
            return;
        }
        self.stack.push((path.clone(), Some(name.span)));
        self.graph(path, &bytes);
        self.stack.pop();
    }

    fn shader(&mut self, graph: &Graph, name: &Name) {
        if self.links.get(&graph.path).is_some_and(|links| links.contains_key(&name.value)) {
            return;
        }
        let path = match files::find(self.files, Kind::Shader, &name.value, Some(&graph.path)) {
            Ok(found) => found.path,
            Err(missing) => {
                self.read.extend(missing.tried.iter().cloned());
                self.diagnostics.push(missing_file(&name.value, Kind::Shader, &missing, Some(name.span)));
                return;
            }
        };
        self.link(graph, name, &path);
        if self.gathered.iter().all(|(known, _)| *known != path) {
            self.gathered.push((path, Gathered::new(self.files, self.sources, &name.value, Some(&graph.path))));
        }
    }

    fn link(&mut self, graph: &Graph, name: &Name, path: &Path) {
        self.links.entry(graph.path.clone()).or_default().insert(name.value.clone(), path.to_owned());
    }

    /// Parses all shaders, on all processors: that takes most of the time of loading.
    fn parse(&mut self) {
        let (paths, gathered): (Vec<_>, Vec<_>) = std::mem::take(&mut self.gathered).into_iter().unzip();
        let parsed = in_parallel(&gathered, &Gathered::parse);
        for ((path, gathered), parsed) in paths.into_iter().zip(gathered).zip(parsed) {
            let loaded = gathered.finish(parsed);
            self.diagnostics.extend(loaded.diagnostics);
            self.read.extend(loaded.read);
            self.shaders.insert(path, loaded.module.map(Arc::new));
        }
    }

    fn text(&mut self, path: &Path, bytes: &[u8]) -> Option<FileId> {
        match std::str::from_utf8(bytes) {
            Ok(text) => Some(self.sources.add(path.display().to_string(), text)),
            Err(error) => {
                let message = format!("{} is not UTF-8: byte {} is no character", path.display(), error.valid_up_to());
                self.diagnostics.push(Diagnostic::error(Code::FILE_UNREADABLE, message));
                None
            }
        }
    }
}

/// Visits every node of a pass list, also inside loops, branches and steps.
pub fn each_node<'a>(nodes: &'a [Node], visit: &mut dyn FnMut(&'a Node)) {
    for node in nodes {
        visit(node);
        match &node.kind {
            NodeKind::Repeat(r) => each_node(&r.passes, visit),
            NodeKind::Steps(s) => each_node(&s.passes, visit),
            NodeKind::If(i) => {
                each_node(&i.then, visit);
                each_node(&i.otherwise, visit);
            }
            _ => {}
        }
    }
}

fn include_cycle(open: &[(PathBuf, Option<Span>)], path: &Path, at: Span) -> Diagnostic {
    let message = format!("{} includes itself", path.display());
    let mut diagnostic = Diagnostic::error(Code::INCLUDE_CYCLE, message).at(at, "this closes the circle");
    for (included, by) in open.iter().skip(1) {
        if let Some(span) = by {
            diagnostic = diagnostic.see(*span, format!("{} is included here", included.display()));
        }
    }
    diagnostic
}

/// A file that a graph or the command line names and that cannot be had.
pub fn missing_file(name: &str, kind: Kind, missing: &NotFound, at: Option<Span>) -> Diagnostic {
    let what = match kind {
        Kind::Graph => "graph",
        Kind::Shader => "shader",
        Kind::Scene => "scene",
        Kind::Asset => "file",
    };
    let mut diagnostic = match &missing.error {
        Some(error) => Diagnostic::error(Code::FILE_UNREADABLE, format!("cannot read the {what} `{name}`: {error}")),
        None => Diagnostic::error(Code::FILE_MISSING, format!("there is no {what} `{name}`")),
    };
    if let Some(span) = at {
        diagnostic = diagnostic.at(span, "named here");
    }
    if missing.error.is_none() {
        let tried: Vec<String> = missing.tried.iter().map(|p| p.display().to_string()).collect();
        diagnostic = diagnostic.hint(format!("looked for {}", tried.join(", ")));
        let folder = if kind == Kind::Graph { "graphs/" } else { "shaders/" };
        diagnostic = diagnostic.nearest(name, files::library().filter_map(|f| f.strip_prefix(folder)));
    }
    diagnostic
}
