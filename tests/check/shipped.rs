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

/// The checker is asked at every save: it answers before a person has looked up. Only an
/// optimized build says something about that.
#[test]
fn checking_a_shipped_graph_takes_less_than_50_ms() {
    let mut slow = Vec::new();
    for path in graphs() {
        let best = (0..5)
            .map(|_| {
                let start = std::time::Instant::now();
                all_said(&DiskFiles, path.to_str().unwrap(), None);
                start.elapsed()
            })
            .min()
            .unwrap();
        eprintln!("{:>9.2} ms  {}", best.as_secs_f64() * 1e3, path.display());
        if best.as_millis() >= 50 {
            slow.push(format!("{}: {best:?}", path.display()));
        }
    }
    if cfg!(debug_assertions) {
        eprintln!("skipped: times of a build that is not optimized are not judged");
        return;
    }
    assert!(slow.is_empty(), "{}", slow.join("\n"));
}
