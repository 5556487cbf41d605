//! Diagnostics as text for people: source lines, carets, every file of a finding in one message.

use std::fmt::Write as _;

use codespan_reporting::diagnostic as report;
use codespan_reporting::files::{Error, Files};
use codespan_reporting::term::{self, termcolor};

use super::{Diagnostic, Diagnostics, FileId, Severity, Sources};

/// Whether text carries terminal colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    Plain,
    Colored,
}

impl<'a> Files<'a> for Sources {
    type FileId = FileId;
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, id: FileId) -> Result<&'a str, Error> {
        Ok(self.path(id))
    }

    fn source(&'a self, id: FileId) -> Result<&'a str, Error> {
        Ok(self.text(id))
    }

    fn line_index(&'a self, id: FileId, offset: usize) -> Result<usize, Error> {
        Ok(self.position(id, offset as u32).line as usize - 1)
    }

    fn line_range(&'a self, id: FileId, line: usize) -> Result<std::ops::Range<usize>, Error> {
        self.line_bytes(id, line).ok_or(Error::LineTooLarge { given: line, max: line })
    }
}

/// One diagnostic as text, ending in a blank line.
pub fn render(diagnostic: &Diagnostic, sources: &Sources, style: Style) -> String {
    let severity = match diagnostic.severity {
        Severity::Error => report::Severity::Error,
        Severity::Warning => report::Severity::Warning,
        Severity::Note => report::Severity::Note,
    };
    let labels = diagnostic.labels.iter().map(|label| {
        let style = if label.primary { report::LabelStyle::Primary } else { report::LabelStyle::Secondary };
        let range = label.span.start as usize..label.span.end as usize;
        report::Label::new(style, label.span.file, range).with_message(&label.text)
    });
    let shown = report::Diagnostic::new(severity)
        .with_code(diagnostic.id.as_str())
        .with_message(&diagnostic.message)
        .with_labels(labels.collect())
        .with_notes(diagnostic.hints.iter().map(|h| format!("hint: {h}")).collect());
    let config = term::Config { tab_width: 4, ..term::Config::default() };
    let mut text = Vec::new();
    let written = match style {
        Style::Plain => term::emit_to_io_write(&mut text, &config, sources, &shown),
        Style::Colored => term::emit_to_write_style(&mut termcolor::Ansi::new(&mut text), &config, sources, &shown),
    };
    match written {
        Ok(()) => String::from_utf8_lossy(&text).into_owned(),
        // A span outside its file: still say what is wrong.
        Err(_) => format!("{}: {}\n\n", diagnostic.id.as_str(), diagnostic.message),
    }
}

/// All diagnostics in order, and a closing count where there is more than one error or any warning.
pub fn render_all(diagnostics: &Diagnostics, sources: &Sources, style: Style) -> String {
    let mut text: String = diagnostics.iter().map(|d| render(d, sources, style)).collect();
    let (errors, warnings) = (diagnostics.count(Severity::Error), diagnostics.count(Severity::Warning));
    let plural = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    match (errors, warnings) {
        (0, 0) => {}
        (0, w) => _ = writeln!(text, "{}", plural(w, "warning")),
        (e, 0) => _ = writeln!(text, "{}", plural(e, "error")),
        (e, w) => _ = writeln!(text, "{}, {}", plural(e, "error"), plural(w, "warning")),
    }
    text
}
