//! A graph file into its [`Graph`]: form, names and literals, with every mistake reported in one
//! go. An entry that cannot be read is left out, all others stand.
//!
//! What needs more than the one file (whether a name exists, sizes, shaders) is not judged here.

mod defaults;
mod draw;
mod inputs;
mod names;
mod params;
mod passes;
mod resources;
mod values;

pub use names::{SAMPLERS, SCALARS};

use std::path::Path;

use self::values::{Named, named};
use super::expr;
use super::model::{Graph, Let, Output, Stat};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, FileId, Sources};
use crate::syntax::{self, Decoder, Fields, Kind, Node};

const FIELDS: &[&str] =
    &["about", "inputs", "params", "let", "resources", "state", "samplers", "passes", "outputs", "stats"];

/// Reads a file of `sources` as a graph. With errors in the diagnostics the graph is what could
/// be made out, if anything; it is not fit for planning.
pub fn read(sources: &Sources, file: FileId, path: &Path) -> (Option<Graph>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let node = syntax::parse(sources, file, &mut diagnostics);
    let graph = node.and_then(|node| graph(&mut Decoder { diagnostics: &mut diagnostics }, &node, file, path));
    // In the order of the file, so that they can be mended from the top.
    diagnostics.0.sort_by_key(|d| d.labels.iter().find(|label| label.primary).map(|label| label.span.start));
    (graph, diagnostics)
}

fn graph(d: &mut Decoder<'_>, node: &Node, file: FileId, path: &Path) -> Option<Graph> {
    let Some(tagged) = node.as_tagged().filter(|t| t.name.as_ref().is_some_and(|n| n.value == "Graph")) else {
        let message = format!("a graph file holds `Graph(...)`, found {}", node.describe());
        d.push(Diagnostic::error(Code::WRONG_VALUE, message).at(node.head(), "`Graph(` is expected here"));
        return None;
    };
    let fields = d.body_fields(tagged, "`Graph`", FIELDS)?;
    let mut resources = section(d, &fields, "resources", |d, e| resources::resource(d, e, false));
    resources.extend(section(d, &fields, "state", |d, e| resources::resource(d, e, true)));
    let passes = fields.require(d, "passes").map(|node| passes::list(d, node, "`passes`")).unwrap_or_default();
    let graph = Graph {
        path: path.to_path_buf(),
        file,
        span: tagged.head,
        about: values::about(d, &fields),
        inputs: section(d, &fields, "inputs", inputs::input),
        params: section(d, &fields, "params", params::param),
        lets: section(d, &fields, "let", binding),
        resources,
        samplers: section(d, &fields, "samplers", resources::sampler),
        passes,
        outputs: fields.get("outputs").map(|node| outputs(d, node)).unwrap_or_default(),
        stats: section(d, &fields, "stats", stat),
    };
    if fields.get("outputs").is_none() {
        _ = fields.require(d, "outputs");
    }
    names::check(d, &graph);
    Some(graph)
}

/// The entries of a map of named things that can be read.
fn section<T>(
    d: &mut Decoder<'_>,
    fields: &Fields<'_>,
    name: &str,
    mut read: impl FnMut(&mut Decoder<'_>, &Named<'_>) -> Option<T>,
) -> Vec<T> {
    let Some(node) = fields.get(name) else { return Vec::new() };
    named(d, node, &format!("`{name}`")).iter().filter_map(|entry| read(d, entry)).collect()
}

fn binding(d: &mut Decoder<'_>, entry: &Named<'_>) -> Option<Let> {
    let expr = values::expr(d, entry.node, &format!("`{}`", entry.name.value))?;
    Some(Let { name: entry.name.clone(), expr })
}

fn stat(d: &mut Decoder<'_>, entry: &Named<'_>) -> Option<Stat> {
    let Kind::Str(text) = &entry.node.kind else {
        d.wrong(entry.node, &format!("the statistic `{}`", entry.name.value), "an expression in a string");
        return None;
    };
    match expr::parse_stat(&text.value, text.inner, text.exact) {
        Ok(expr) => Some(Stat { name: entry.name.clone(), text: text.value.clone(), expr }),
        Err(diagnostic) => {
            d.push(diagnostic);
            None
        }
    }
}

/// A list of names, or a map from the outer names.
fn outputs(d: &mut Decoder<'_>, node: &Node) -> Vec<Output> {
    let mut outputs: Vec<Output> = match &node.kind {
        Kind::Map(_) => named(d, node, "`outputs`")
            .iter()
            .filter_map(|entry| {
                let of = values::path(d, entry.node, &format!("the output `{}`", entry.name.value))?;
                Some(Output { name: entry.name.clone(), of })
            })
            .collect(),
        Kind::List(items) => items
            .iter()
            .filter_map(|item| values::path(d, item, "an entry of `outputs`"))
            .map(|of| Output { name: of.clone(), of })
            .collect(),
        _ => {
            d.wrong(node, "`outputs`", "a list of names, or a map from names to names");
            return Vec::new();
        }
    };
    let mut kept: Vec<Output> = Vec::new();
    for output in outputs.drain(..) {
        match kept.iter().find(|first| first.name.value == output.name.value) {
            Some(first) => d.push(names::duplicate("the output", &output.name, first.name.span)),
            None => kept.push(output),
        }
    }
    kept
}
