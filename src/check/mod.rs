//! Checking without a device: a program is planned for a stand-in scene, at its defaults and with
//! one thing at a time otherwise, and every mistake that turns up is reported once.
//!
//! What a warning says ("unused") must hold in every variant; an error in any one is an error.

mod passes;
mod variants;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::plan;
use crate::plan::model::{Plan, Request};
use crate::plan::needs::feature_names;
use crate::program::Program;

/// Everything that is wrong with a program, and what is odd about it in every variant.
pub fn check(program: &Program) -> Diagnostics {
    let mut found = passes::names(program);
    let base = variants::base(program);
    let plan = match plan::instantiate_stand_in(program, &base) {
        Ok(plan) => plan,
        // The variants would only say the same again.
        Err(diagnostics) => {
            found.extend(diagnostics);
            return found;
        }
    };
    let mut odd = oddities(&plan);
    for (said, request) in variants::others(program, &base, &plan) {
        match plan::instantiate_stand_in(program, &request) {
            Ok(plan) => {
                let now = oddities(&plan);
                odd.retain(|d| now.iter().any(|n| n.id == d.id && n.labels == d.labels));
            }
            Err(diagnostics) => {
                for diagnostic in diagnostics.0 {
                    keep_new(&mut found, diagnostic, &said);
                }
            }
        }
    }
    for diagnostic in odd.into_iter().chain(beyond_defaults(program, &plan)) {
        found.push(diagnostic);
    }
    found
}

/// What the graph needs that not every device has.
fn beyond_defaults(program: &Program, plan: &Plan) -> Option<Diagnostic> {
    let features = feature_names(plan.needs.features).into_iter().map(|name| format!("the feature `{name}`"));
    let limits = plan.needs.limits.iter().map(|(name, needed, default)| format!("`{name}` of {needed} (of {default})"));
    let all: Vec<String> = features.chain(limits).collect();
    if all.is_empty() {
        return None;
    }
    let message = format!("the graph needs more than every WebGPU device has: {}", all.join(", "));
    let diagnostic = Diagnostic::note(Code::NEEDS, message).at(program.root.span, "this graph");
    Some(
        diagnostic
            .hint("`If(test: \"device(...)\", then: [...], else: [...])` offers another way where it is not there"),
    )
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
        let message = format!("the pass `{}` is left out: {}", culled.path, culled.why);
        let diagnostic = Diagnostic::warning(Code::CULLED, message)
            .at(culled.span, "never runs")
            .hint("put what it writes among the `outputs`, or let a pass read it");
        // A loop's pass is one pass, however often it goes round.
        if !all.iter().any(|known| known.labels == diagnostic.labels) {
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
