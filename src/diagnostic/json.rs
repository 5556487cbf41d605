//! Diagnostics as JSON for editors: one array, positions in lines, columns and bytes.

use serde_json::{Value, json};

use super::{Diagnostics, Severity, Sources};

/// A JSON array of all diagnostics. Lines and columns count from 1, columns in characters;
/// `start` and `end` are byte offsets in the file.
pub fn to_json(diagnostics: &Diagnostics, sources: &Sources) -> Value {
    diagnostics.iter().map(|d| diagnostic(d, sources)).collect()
}

fn diagnostic(d: &super::Diagnostic, sources: &Sources) -> Value {
    let labels: Vec<Value> = d
        .labels
        .iter()
        .map(|label| {
            let (file, span) = (label.span.file, label.span);
            let (from, to) = (sources.position(file, span.start), sources.position(file, span.end));
            json!({
                "file": sources.path(file),
                "line": from.line, "column": from.column,
                "end_line": to.line, "end_column": to.column,
                "start": span.start, "end": span.end,
                "primary": label.primary,
                "text": label.text,
            })
        })
        .collect();
    json!({
        "id": d.id.as_str(),
        "severity": match d.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        },
        "message": d.message,
        "labels": labels,
        "hints": d.hints,
    })
}
