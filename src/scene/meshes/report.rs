//! What a reader found wrong, each with the file and the place in it.

use std::fmt::Display;
use std::path::Path;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};

/// Findings about one file.
#[derive(Debug)]
pub(super) struct Report {
    path: String,
    found: Diagnostics,
    /// Findings that were not kept.
    more: usize,
    /// What may still be made of the file.
    room: usize,
}

/// One fault often repeats itself over a whole file: nobody reads more of them.
const MOST_FINDINGS: usize = 20;

/// Bytes that a byte of a file may become. Positions of three bytes grow most: to 72 bytes of
/// filled attributes each.
const GROWTH: usize = 64;
/// Bytes that any file may become.
const ALLOWANCE: usize = 16 << 20;

impl Report {
    /// For a file whose parts have `size` bytes together.
    pub fn new(path: &Path, size: usize) -> Self {
        let room = size.saturating_mul(GROWTH).saturating_add(ALLOWANCE);
        Self { path: path.display().to_string(), found: Diagnostics::new(), more: 0, room }
    }

    pub fn error(&mut self, place: impl Display, message: impl Display) {
        self.push(Diagnostic::error(Code::ASSET, self.text(place, message)));
    }

    pub fn error_with_hint(&mut self, place: impl Display, message: impl Display, hint: &str) {
        self.push(Diagnostic::error(Code::ASSET, self.text(place, message)).hint(hint));
    }

    pub fn warn(&mut self, place: impl Display, message: impl Display) {
        self.push(Diagnostic::warning(Code::ASSET_NOTE, self.text(place, message)));
    }

    pub fn note(&mut self, place: impl Display, message: impl Display) {
        self.push(Diagnostic::note(Code::ASSET_NOTE, self.text(place, message)));
    }

    /// Takes room for `bytes`; false, with an error, if the file cannot justify them.
    pub fn take(&mut self, bytes: usize, place: impl Display) -> bool {
        self.take_for(bytes, "triangles", place)
    }

    /// The same for what is no triangles.
    pub fn take_for(&mut self, bytes: usize, what: &str, place: impl Display) -> bool {
        match self.room.checked_sub(bytes) {
            Some(left) => {
                self.room = left;
                true
            }
            None => {
                let message = format!("the file describes far more {what} than its size can justify");
                self.error(place, format!("{message}: reading stops here"));
                self.room = 0;
                false
            }
        }
    }

    pub fn has_errors(&self) -> bool {
        self.found.has_errors()
    }

    /// All findings.
    pub fn finish(mut self) -> Diagnostics {
        if self.more > 0 {
            let severity = if self.found.has_errors() { Severity::Error } else { Severity::Warning };
            let code = if severity == Severity::Error { Code::ASSET } else { Code::ASSET_NOTE };
            let message = format!("`{}`: and {} more of such findings", self.path, self.more);
            self.found.push(Diagnostic::new(code, severity, message));
        }
        self.found
    }

    fn text(&self, place: impl Display, message: impl Display) -> String {
        let place = place.to_string();
        if place.is_empty() {
            return format!("`{}`: {message}", self.path);
        }
        format!("`{}`: {place}: {message}", self.path)
    }

    fn push(&mut self, diagnostic: Diagnostic) {
        let of_its_kind = self.found.count(diagnostic.severity);
        if of_its_kind < MOST_FINDINGS || self.found.iter().any(|d| *d == diagnostic) {
            self.found.push(diagnostic);
        } else {
            self.more += 1;
        }
    }
}

/// `text` as a message may show it: quoted, clipped, without control characters.
pub(super) fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let clipped: String = text.chars().take(LONGEST).collect();
    let more = if clipped.len() < text.len() { "…" } else { "" };
    format!("`{}{more}`", clipped.escape_debug())
}

/// `1 vertex`, `2 vertices` from "vertex" and "vertices".
pub(super) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
