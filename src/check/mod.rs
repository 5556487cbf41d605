//! Checking without a device: a program is planned for a stand-in scene, at its defaults and with
//! one thing at a time otherwise, and every mistake that turns up is reported once.
//!
//! What a warning says ("unused") must hold in every variant; an error in any one is an error.

mod branches;
mod clashes;
mod device;
mod passes;
mod variants;

pub use device::Device;
use variants::Variant;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity, Span};
use crate::parallel::in_parallel;
use crate::plan::model::Request;
use crate::plan::needs::feature_names;
use crate::plan::{Findings, examine, instantiate_stand_in};
use crate::program::Program;

/// Everything that is wrong with a program, and what is odd about it in every variant.
pub fn check(program: &Program) -> Diagnostics {
    check_in(program, Way::Short)
}

/// The same the long way, for comparison: whole plans, and every parameter by itself at every
/// value that is tried, whether or not anything but a uniform's content hangs on it.
#[doc(hidden)]
pub fn check_at_length(program: &Program) -> Diagnostics {
    check_in(program, Way::Long)
}

/// How much is gone through to find everything.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Short,
    Long,
}

impl Way {
    fn examine(self, program: &Program, request: &Request) -> Result<Findings, Diagnostics> {
        match self {
            Way::Short => examine(program, request),
            Way::Long => instantiate_stand_in(program, request).map(Findings::from),
        }
    }
}

fn check_in(program: &Program, way: Way) -> Diagnostics {
    let (mut found, base) = check_with(program, &Device::anything(), way);
    base.and_then(|base| beyond_defaults(program, &base)).into_iter().for_each(|note| found.push(note));
    found
}

/// The same for a device: what it lacks is an error with the parameters' defaults, and a warning
/// with other values.
pub fn check_on(program: &Program, device: &Device) -> Diagnostics {
    let (found, _) = check_with(program, device, Way::Short);
    let is_default = |d: &Diagnostic| !d.hints.iter().any(|hint| hint.starts_with(FOUND_WITH));
    let explained = found.0.into_iter().map(|d| (is_default(&d), d)).map(|(at, d)| device.explain(d, at));
    Diagnostics(explained.collect())
}

fn check_with(program: &Program, device: &Device, way: Way) -> (Diagnostics, Option<Findings>) {
    let mut found = passes::names(program);
    found.extend(clashes::clashes(program));
    found.extend(branches::differing(program));
    let base = variants::base(program, device);
    let at_base = match way.examine(program, &base) {
        Ok(at_base) => at_base,
        // The variants would only say the same again.
        Err(diagnostics) => {
            // A clash was told where the names are declared; not again at the shader that uses them.
            let is_clash = |d: &Diagnostic| d.id == Code::NAME_CLASH;
            let told = found.iter().any(is_clash);
            found.extend(Diagnostics(diagnostics.0.into_iter().filter(|d| !(told && is_clash(d))).collect()));
            return (found, None);
        }
    };
    let mut odd = oddities(&at_base);
    let variants = variants::others(program, &base, &at_base, way);
    for outcome in in_parallel(&variants, &|variant| outcomes(program, variant, way)).into_iter().flatten() {
        match outcome {
            Ok(now) => odd.retain(|d| now.iter().any(|n| n.id == d.id && n.labels == d.labels)),
            Err((diagnostics, said)) => {
                for diagnostic in diagnostics.0 {
                    keep_new(&mut found, diagnostic, said);
                }
            }
        }
    }
    odd.into_iter().for_each(|diagnostic| found.push(diagnostic));
    (found, Some(at_base))
}

/// The oddities of a variant, or its errors and the words that say what it is.
type Outcome<'a> = Result<Vec<Diagnostic>, (Diagnostics, &'a str)>;

/// The outcome of a variant; if it is several things at once and fails, that of each.
fn outcomes<'a>(program: &Program, variant: &'a Variant, way: Way) -> Vec<Outcome<'a>> {
    match way.examine(program, &variant.request) {
        Ok(found) => vec![Ok(oddities(&found))],
        Err(_) if !variant.each.is_empty() => {
            variant.each.iter().flat_map(|each| outcomes(program, each, way)).collect()
        }
        Err(diagnostics) => vec![Err((diagnostics, &variant.said))],
    }
}

/// What the graph needs that not every device has.
fn beyond_defaults(program: &Program, base: &Findings) -> Option<Diagnostic> {
    let features = feature_names(base.needs.features).into_iter().map(|name| format!("the feature `{name}`"));
    let limits = base.needs.limits.iter().map(|(name, needed, default)| format!("`{name}` of {needed} (of {default})"));
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
    variants::base(program, &Device::anything())
}

/// Warnings of a plan, and passes that it culls: the same pass in a loop or in a part used twice
/// counts as culled only if it is so everywhere.
fn oddities(found: &Findings) -> Vec<Diagnostic> {
    let mut all: Vec<Diagnostic> = found.warnings.iter().cloned().collect();
    for culled in &found.culled {
        let holds = |p: &Span| p.file == culled.span.file && p.start <= culled.span.start && culled.span.end <= p.end;
        if found.passes.iter().any(holds) {
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

/// How the hint of what only a variant shows begins.
const FOUND_WITH: &str = "found with ";

/// Keeps an error that was not seen yet, saying with which variant it came.
fn keep_new(found: &mut Diagnostics, diagnostic: Diagnostic, said: &str) {
    let seen = found.iter().any(|d| d.id == diagnostic.id && d.labels == diagnostic.labels);
    if diagnostic.severity == Severity::Error && !seen {
        found.push(diagnostic.hint(format!("{FOUND_WITH}{said}; the defaults are fine")));
    }
}
