//! Explanations as text and as JSON.

use std::fmt::Write as _;

use serde_json::{Map, Value as Json, json};

use crate::plan::explain::Explanation;

/// Behind which what is said begins.
const WIDTH: usize = 12;

/// One paragraph for each.
pub fn explained(all: &[Explanation]) -> String {
    let mut out = String::new();
    for (nth, Explanation { kind, path, facts }) in all.iter().enumerate() {
        let gap = if nth > 0 { "\n" } else { "" };
        _ = writeln!(out, "{gap}{kind} {path}");
        for (about, lines) in facts {
            for (nth, line) in lines.iter().enumerate() {
                let about = if nth == 0 { about } else { "" };
                _ = writeln!(out, "  {about:WIDTH$}{line}");
            }
        }
    }
    out
}

/// One array; what is said is lists of sentences under the same words as in the text.
pub fn explained_json(all: &[Explanation]) -> String {
    let one = |explanation: &Explanation| {
        let mut fields = Map::new();
        fields.insert("kind".into(), json!(explanation.kind));
        fields.insert("path".into(), json!(explanation.path));
        for (about, lines) in &explanation.facts {
            fields.insert(about.replace(' ', "_"), json!(lines));
        }
        Json::Object(fields)
    };
    format!("{:#}\n", all.iter().map(one).collect::<Json>())
}
