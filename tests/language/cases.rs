//! Each `cases/NAME.ron` is a wrong graph, and `cases/NAME.txt` the whole text that is said about
//! it. Each `valid/NAME.ron` reads without errors.

use std::path::{Path, PathBuf};

use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::graph::{self, model::Graph};
use meniscus::syntax;

use crate::golden;

/// The graphs in a folder under `tests/language`, sorted.
pub fn graphs(folder: &str) -> Vec<PathBuf> {
    let folder = golden::root().join("tests/language").join(folder);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "ron"));
    paths.sort();
    assert!(!paths.is_empty());
    paths
}

/// Reads a file as a graph; messages show its bare name.
pub fn read(path: &Path) -> (Option<Graph>, Diagnostics, Sources) {
    let bytes = std::fs::read(path).unwrap();
    let name = PathBuf::from(path.file_name().unwrap());
    let mut sources = Sources::new();
    match syntax::add_bytes(&mut sources, &name, &bytes) {
        Ok(file) => {
            let (graph, diagnostics) = graph::read(&sources, file, &name);
            (graph, diagnostics, sources)
        }
        Err(diagnostic) => (None, diagnostic.into(), sources),
    }
}

#[test]
fn every_wrong_graph_is_told_as_its_golden_says() {
    let mut reports = Vec::new();
    for path in graphs("cases") {
        let (_, diagnostics, sources) = read(&path);
        let text = render_all(&diagnostics, &sources, Style::Plain);
        let expected = path.strip_prefix(golden::root()).unwrap().with_extension("txt");
        reports.extend(golden::compare(&expected, &text).err());
    }
    assert!(reports.is_empty(), "{}", reports.join("\n\n"));
}

#[test]
fn every_wrong_graph_is_found_wrong() {
    for path in graphs("cases") {
        assert!(!read(&path).1.is_empty(), "{} gives no diagnostic", path.display());
    }
}

#[test]
fn valid_graphs_read_without_errors() {
    for path in graphs("valid") {
        let (graph, diagnostics, sources) = read(&path);
        assert!(!diagnostics.has_errors(), "{}", render_all(&diagnostics, &sources, Style::Plain));
        assert!(graph.is_some());
    }
}

/// Reads a text as a graph.
pub fn read_text(text: &str) -> (Option<Graph>, Diagnostics, Sources) {
    let mut sources = Sources::new();
    let file = sources.add("graph.ron", text);
    let (graph, diagnostics) = graph::read(&sources, file, Path::new("graph.ron"));
    (graph, diagnostics, sources)
}
