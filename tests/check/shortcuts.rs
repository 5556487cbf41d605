//! Checking takes short cuts: it makes no whole plans, and leaves out values of parameters on which
//! nothing hangs but what uniforms hold. What it says is what it would say without.

use meniscus::check;
use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::files::{DiskFiles, Files};
use meniscus::program;

use super::{cases, shipped};

/// What differs, of all that is said.
fn difference(files: &dyn Files, path: &str) -> Option<String> {
    let mut sources = Sources::new();
    let program = program::load(files, &mut sources, path, None).program?;
    let told = |mut found: Diagnostics| {
        // Which of several values is named as the one that shows a mistake may differ.
        for diagnostic in &mut found.0 {
            diagnostic.hints.retain(|hint| !hint.starts_with("found with "));
        }
        render_all(&found, &sources, Style::Plain)
    };
    let (short, long) = (told(check::check(&program)), told(check::check_at_length(&program)));
    (short != long).then(|| format!("{path}\n--- in short\n{short}\n--- at length\n{long}"))
}

#[test]
fn wrong_graphs_are_told_the_same_without_short_cuts() {
    let all = cases::cases();
    let different: Vec<String> = all
        .iter()
        .filter_map(|case| {
            difference(&case.files, "graph.ron").map(|difference| format!("{}: {difference}", case.name))
        })
        .collect();
    assert!(different.is_empty(), "{}", different.join("\n\n"));
}

#[test]
fn shipped_graphs_are_told_the_same_without_short_cuts() {
    let different: Vec<String> =
        shipped::graphs().iter().filter_map(|path| difference(&DiskFiles, path.to_str()?)).collect();
    assert!(different.is_empty(), "{}", different.join("\n\n"));
}
