//! What is wrong, where, and how to mend it.
//!
//! A [`Diagnostic`] is a value: a stable id, a severity, a message, labels with spans in any
//! number of files, and hints. Nothing here prints or exits; [`render_all`] and [`to_json`] turn values
//! into output, and whoever drives a command decides what to do with them.
//!
//! Messages are lower case, name the thing and say what was expected and what was found; the
//! remedy is a hint.

mod codes;
mod json;
mod source;
mod text;

pub use codes::{Code, explain, explained};
pub use json::to_json;
pub use source::{FileId, Position, Sources, Span};
pub use text::{Style, render, render_all};

/// How grave a diagnostic is. Warnings become findings only under `--deny-warnings`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    Note,
    Warning,
    Error,
}

/// A place in a file and what is to be said about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    pub span: Span,
    pub text: String,
    /// The place that the message is about; the others give context.
    pub primary: bool,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// A stable kebab-case id, such as `unknown-name`; `meniscus explain ID` tells more.
    pub id: Code,
    pub severity: Severity,
    pub message: String,
    pub labels: Vec<Label>,
    /// How to mend it, one remedy each.
    pub hints: Vec<String>,
}

impl Diagnostic {
    pub fn error(id: Code, message: impl Into<String>) -> Self {
        Self::new(id, Severity::Error, message)
    }

    pub fn warning(id: Code, message: impl Into<String>) -> Self {
        Self::new(id, Severity::Warning, message)
    }

    pub fn note(id: Code, message: impl Into<String>) -> Self {
        Self::new(id, Severity::Note, message)
    }

    pub fn new(id: Code, severity: Severity, message: impl Into<String>) -> Self {
        Self { id, severity, message: message.into(), labels: Vec::new(), hints: Vec::new() }
    }

    /// Adds the place that the message is about.
    #[must_use]
    pub fn at(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into(), primary: true });
        self
    }

    /// Adds a place that gives context.
    #[must_use]
    pub fn see(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into(), primary: false });
        self
    }

    /// Adds a remedy.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hints.push(hint.into());
        self
    }

    /// Adds "did you mean" if one of `known` is close to `name`.
    #[must_use]
    pub fn nearest<'a>(self, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        match nearest(name, known) {
            Some(best) => self.hint(format!("did you mean `{best}`?")),
            None => self,
        }
    }
}

/// The closest of `known` to `name`, if any is close enough to be a likely slip.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (name.chars().count() / 3).max(1);
    known
        .into_iter()
        .filter(|k| *k != name)
        .map(|k| (strsim::damerau_levenshtein(name, k), k))
        .filter(|(distance, k)| *distance <= limit || k.eq_ignore_ascii_case(name))
        .min_by_key(|(distance, k)| (*distance, *k))
        .map(|(_, k)| k)
}

/// Diagnostics gathered over a run, so that one run reports all of them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl Diagnostics {
    pub fn new() -> Self {
        Self::default()
    }

    /// Keeps a finding; an equal one that is already there is not repeated (a part that is used
    /// twice shows its faults once).
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if !self.0.contains(&diagnostic) {
            self.0.push(diagnostic);
        }
    }

    pub fn extend(&mut self, other: Diagnostics) {
        for diagnostic in other.0 {
            self.push(diagnostic);
        }
    }

    pub fn has_errors(&self) -> bool {
        self.0.iter().any(|d| d.severity == Severity::Error)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.0.iter()
    }

    pub fn count(&self, severity: Severity) -> usize {
        self.0.iter().filter(|d| d.severity == severity).count()
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Self {
        Self(vec![diagnostic])
    }
}
