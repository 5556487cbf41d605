//! The plan of every shipped graph as text, for the scene that `check` uses.

use std::path::{Path, PathBuf};

use meniscus::check;
use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::files::DiskFiles;
use meniscus::plan::instantiate_stand_in;
use meniscus::plan::model::Plan;
use meniscus::plan::print;
use meniscus::program;

use crate::golden;

/// Every graph file, from the root of the repository.
pub fn graphs() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in ["graphs", "graphs/parts"] {
        for entry in std::fs::read_dir(golden::root().join(folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            if name.ends_with(".ron") {
                found.push(Path::new(folder).join(name));
            }
        }
    }
    found.sort();
    assert!(found.len() > 10, "the shipped graphs are not where they should be: {found:?}");
    found
}

/// The plan that `meniscus plan` shows of a graph by itself.
pub fn plan(graph: &Path) -> Result<Plan, String> {
    let mut sources = Sources::new();
    let loaded = program::load(&DiskFiles, &mut sources, graph.to_str().unwrap(), None);
    let Some(program) = loaded.program else { return Err(render_all(&loaded.diagnostics, &sources, Style::Plain)) };
    let request = check::stand_in(&program);
    instantiate_stand_in(&program, &request).map_err(|found| render_all(&found, &sources, Style::Plain))
}

/// A graph's name, with `parts_` before that of a part.
fn flat(graph: &Path) -> String {
    graph.strip_prefix("graphs").unwrap().with_extension("").to_str().unwrap().replace(['/', '\\'], "_")
}

#[test]
fn plans_of_shipped_graphs() {
    std::env::set_current_dir(golden::root()).unwrap();
    let mut reports = Vec::new();
    for graph in graphs() {
        let compared = plan(&graph).and_then(|plan| {
            golden::compare(format!("tests/plan/shipped/{}.txt", flat(&graph)).as_ref(), &print::text(&plan))
        });
        reports.extend(compared.err().map(|report| format!("{}: {report}", graph.display())));
    }
    assert!(reports.is_empty(), "{}", reports.join("\n\n"));
}

#[test]
fn no_plan_is_without_its_graph() {
    let known: Vec<String> = graphs().iter().map(|graph| format!("{}.txt", flat(graph))).collect();
    for entry in std::fs::read_dir(golden::root().join("tests/plan/shipped")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(known.contains(&name), "tests/plan/shipped/{name} belongs to no graph");
    }
}

#[test]
fn shipped_plans_share_memory_only_where_lives_do_not_meet() {
    for graph in graphs() {
        let plan = plan(&graph).unwrap();
        super::memory::hold(&plan);
    }
}
