//! `check`: what is said about wrong programs, and that nothing is said about right ones.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/golden.rs"]
mod golden;

mod check {
    mod cases;
    mod devices;
    mod ids;
    mod mutations;
    mod requests;
    mod shipped;
    mod shortcuts;

    use std::path::Path;

    use meniscus::check::check;
    use meniscus::diagnostic::{Diagnostics, Sources};
    use meniscus::files::Files;
    use meniscus::program;

    /// Everything that is said about a graph file.
    fn all_said(files: &dyn Files, graph: &str, beside: Option<&Path>) -> (Diagnostics, Sources) {
        let mut sources = Sources::new();
        let loaded = program::load(files, &mut sources, graph, beside);
        let mut found = loaded.diagnostics;
        if let Some(program) = &loaded.program {
            found.extend(check(program));
        }
        (found, sources)
    }
}
