//! Nothing is found in what is shipped.

use std::path::{Path, PathBuf};

use meniscus::diagnostic::{Severity, Style, render_all};
use meniscus::files::DiskFiles;

use super::all_said;
use crate::golden;

/// Every graph file under `graphs/`, sorted.
pub fn graphs() -> Vec<PathBuf> {
    let mut all = Vec::new();
    gather(&golden::root().join("graphs"), &mut all);
    all.sort();
    assert!(all.len() > 8, "the graphs are not there");
    all
}

fn gather(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            gather(&path, all);
        } else if path.extension().is_some_and(|e| e == "ron") {
            all.push(path);
        }
    }
}

#[test]
fn shipped_graphs_have_no_errors_and_no_warnings() {
    let mut reports = Vec::new();
    for path in graphs() {
        let (found, sources) = all_said(&DiskFiles, path.to_str().unwrap(), None);
        // Notes tell what a device must have.
        if found.iter().any(|d| d.severity != Severity::Note) {
            reports.push(format!("{}:\n{}", path.display(), render_all(&found, &sources, Style::Plain)));
        }
    }
    assert!(reports.is_empty(), "{}", reports.join("\n"));
}
