//! Checking without a device: a program is planned for a stand-in scene, at its defaults and with
//! one thing at a time otherwise, and every mistake that turns up is reported once.
//!
//! What a warning says ("unused") must hold in every variant; an error in any one is an error.

mod variants;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::plan;
use crate::plan::model::{Plan, Request};
use crate::program::Program;

/// Everything that is wrong with a program, and what is odd about it in every variant.
pub fn check(program: &Program) -> Diagnostics {
    let mut found = Diagnostics::new();
    let mut odd: Option<Vec<Diagnostic>> = None;
    let base = variants::base(program);
    let params = match plan::instantiate_stand_in(program, &base) {
        Ok(plan) => {
            odd = Some(oddities(&plan));
            plan.params
        }
        Err(diagnostics) => {
            found.extend(diagnostics);
            Vec::new()
        }
    };
    // With errors at the defaults the variants would only say the same again.
    if found.has_errors() {
        return found;
    }
    for (said, request) in variants::others(program, &base, &params) {
        match plan::instantiate_stand_in(program, &request) {
            Ok(plan) => {
                let now = oddities(&plan);
                if let Some(odd) = &mut odd {
                    odd.retain(|d| now.contains(d));
                }
            }
            Err(diagnostics) => {
                for diagnostic in diagnostics.0 {
                    keep_new(&mut found, diagnostic, &said);
                }
            }
        }
    }
    for diagnostic in odd.into_iter().flatten() {
        found.push(diagnostic);
    }
    found
}

/// The scene that programs are checked with: it has everything that the graph asks for, also what
/// is optional.
pub fn stand_in(program: &Program) -> Request {
    variants::base(program)
}

/// Warnings of a plan, and its culled passes: the same pass in a loop or in a part used twice
/// counts as culled only if it is so everywhere.
fn oddities(plan: &Plan) -> Vec<Diagnostic> {
    let mut all: Vec<Diagnostic> = plan.warnings.iter().cloned().collect();
    for culled in &plan.culled {
        if plan.passes.iter().any(|p| {
            p.span.file == culled.span.file && p.span.start <= culled.span.start && culled.span.end <= p.span.end
        }) {
            continue;
        }
        let message = "no output needs this pass";
        let diagnostic = Diagnostic::warning(Code::CULLED, message).at(culled.span, "left out of every plan");
        if !all.contains(&diagnostic) {
            all.push(diagnostic);
        }
    }
    all
}

/// Keeps an error that was not seen yet, saying with which variant it came.
fn keep_new(found: &mut Diagnostics, diagnostic: Diagnostic, said: &str) {
    let seen = found.iter().any(|d| d.id == diagnostic.id && d.labels == diagnostic.labels);
    if diagnostic.severity == Severity::Error && !seen {
        found.push(diagnostic.hint(format!("found with {said}; the defaults are fine")));
    }
}
