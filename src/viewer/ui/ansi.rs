//! Text with terminal colours, as messages are rendered, for egui.

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId};

const PLAIN: Color32 = Color32::from_gray(205);

/// The text with its colours, in a font whose columns line up.
pub fn layout(text: &str, size: f32) -> LayoutJob {
    let mut job = LayoutJob::default();
    for (part, color) in parts(text) {
        let format = TextFormat { font_id: FontId::monospace(size), color, ..TextFormat::default() };
        job.append(part, 0.0, format);
    }
    job.wrap.max_width = f32::INFINITY;
    job
}

/// The pieces between escapes, with the colour of each.
fn parts(text: &str) -> Vec<(&str, Color32)> {
    let mut found = Vec::new();
    let mut color = PLAIN;
    let mut rest = text;
    while let Some(at) = rest.find("\u{1b}[") {
        let (before, after) = rest.split_at(at);
        if !before.is_empty() {
            found.push((before, color));
        }
        let codes = &after[2..];
        let Some(end) = codes.find(|c: char| c.is_ascii_alphabetic()) else { return found };
        if codes[end..].starts_with('m') {
            color = codes[..end].split(';').fold(color, |color, code| colored(code, color));
        }
        rest = &codes[end + 1..];
    }
    if !rest.is_empty() {
        found.push((rest, color));
    }
    found
}

fn colored(code: &str, before: Color32) -> Color32 {
    match code {
        "" | "0" => PLAIN,
        "1" => {
            if before == PLAIN {
                Color32::WHITE
            } else {
                before
            }
        }
        // The last of `38;5;9` and its like names a bright colour.
        "31" | "91" | "9" => Color32::from_rgb(244, 112, 104),
        "32" | "92" | "10" => Color32::from_rgb(126, 205, 136),
        "33" | "93" | "11" => Color32::from_rgb(232, 190, 96),
        "34" | "94" | "12" => Color32::from_rgb(104, 168, 236),
        "35" | "95" | "13" => Color32::from_rgb(206, 146, 226),
        "36" | "96" | "14" => Color32::from_rgb(98, 200, 210),
        _ => before,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_become_colours_and_vanish() {
        let found = parts("a\u{1b}[0m\u{1b}[1m\u{1b}[38;5;9mb\u{1b}[0m\u{1b}[34mc\u{1b}[0m d");
        let text: String = found.iter().map(|(text, _)| *text).collect();
        assert_eq!(text, "abc d");
        assert_eq!(found[2].1, Color32::from_rgb(104, 168, 236));
        assert_eq!(found[3], (" d", PLAIN));
    }

    #[test]
    fn an_escape_that_does_not_end_is_left_out() {
        assert_eq!(parts("a\u{1b}[38;5"), [("a", PLAIN)]);
    }
}
