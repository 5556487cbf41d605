//! `meniscus explain ID`: a diagnostic, at length.

use super::args::ExplainArgs;
use super::report::{Exit, print, report};
use crate::diagnostic::{Code, Diagnostic, Sources, explain, explained};

pub fn run(args: &ExplainArgs) -> Exit {
    let Some(id) = &args.id else {
        return print(&explained().map(|id| format!("{id}\n")).collect::<String>());
    };
    // As it stands in messages, also with its brackets.
    let id = id.trim_start_matches("error").trim_start_matches("warning").trim_matches(['[', ']']);
    match explain(id) {
        Some(text) => print(&format!("{id}\n\n{text}\n")),
        None => {
            let unknown = Diagnostic::error(Code::USAGE, format!("there is no diagnostic `{id}`"))
                .nearest(id, explained())
                .hint("`meniscus explain` lists all");
            report(&unknown.into(), &Sources::new())
        }
    }
}
