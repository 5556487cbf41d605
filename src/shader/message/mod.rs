//! What naga finds wrong, said in the files that the person wrote.

mod function;
mod stage;
mod unknown;
mod validation;

pub(super) use validation::validation_error;

use naga::front::wgsl::ParseError;

use super::assemble::Assembled;
use super::limits;
use super::scan::Unpaired;
use crate::diagnostic::{Code, Diagnostic, FileId, Span};

/// What would make naga point at the wrong file: a comment or a bracket that an imported file
/// leaves open swallows the files behind it.
pub(super) fn broken_text(assembled: &Assembled) -> Option<Diagnostic> {
    if let Some(why) = limits::too_many(&assembled.declarations) {
        return Some(error(why).at(assembled.map.start(), "all told"));
    }
    let units = assembled.map.files().zip(&assembled.texts).enumerate();
    for (at, (file, (text, scan))) in units {
        if let Some((token, why)) = limits::beyond(text, &scan.tokens) {
            let span = Span::new(file, token.start, token.end);
            return Some(finish(error(why).at(span, "the limit is reached here"), assembled));
        }
        if let Some(start) = scan.open_comment {
            let span = Span::new(file, start, start + 2);
            return Some(finish(error("this comment is never closed").at(span, "opened here"), assembled));
        }
        if let Some(unpaired) = scan.unpaired_brace().filter(|_| at != assembled.named) {
            return Some(finish(unpaired_brace(file, unpaired), assembled));
        }
    }
    None
}

fn unpaired_brace(file: FileId, unpaired: Unpaired) -> Diagnostic {
    match unpaired {
        Unpaired::Open(token) => {
            error("this `{` is never closed").at(Span::new(file, token.start, token.end), "opened here")
        }
        Unpaired::Close(token) => {
            error("this `}` closes nothing").at(Span::new(file, token.start, token.end), "nothing is open here")
        }
    }
}

/// naga's parser gives one error at a time.
pub(super) fn parse_error(found: &ParseError, assembled: &Assembled) -> Diagnostic {
    if let Some(diagnostic) = unclosed(found, assembled).or_else(|| too_deep(found, assembled)) {
        return finish(diagnostic, assembled);
    }
    let message = sentence_of(found.message()).replace("found \"\"", "found the end of the file");
    let mut diagnostic = error(message);
    let labels = found.labels().filter_map(|(span, text)| Some((assembled.map.span(span)?, text)));
    for (at, (span, text)) in labels.enumerate() {
        let text = match text {
            "" | "see msg" => "here".to_owned(),
            text => sentence_of(text).replace("{AbstractFloat}", "number").replace("{AbstractInt}", "number"),
        };
        diagnostic = match at {
            0 => diagnostic.at(missing_end(span, assembled).unwrap_or(span), text),
            _ => diagnostic.see(span, text),
        };
    }
    if diagnostic.labels.is_empty() {
        diagnostic = diagnostic.at(assembled.map.start(), "somewhere in this file");
    }
    // The failed conversions are all of what naga tried.
    for note in found.notes().filter(|note| !note.contains("Naga") && !note.contains("couldn't be converted")) {
        diagnostic = diagnostic.hint(sentence_of(note));
    }
    if found.message().contains("convert") {
        diagnostic = diagnostic.hint("write conversions out: `f32(x)`, `u32(x)`, `vec3<f32>(x)`");
    }
    diagnostic = unknown::suggest(diagnostic, found, assembled);
    finish(diagnostic, assembled)
}

/// An error at the very end of a text whose brackets do not pair up is about the bracket.
fn unclosed(found: &ParseError, assembled: &Assembled) -> Option<Diagnostic> {
    let (span, _) = found.labels().next()?;
    let at_end = assembled.whole[..].trim_end().len() <= span.to_range()?.start;
    let (_, scan) = &assembled.texts[assembled.named];
    let unpaired = scan.unpaired_brace().filter(|_| at_end)?;
    Some(unpaired_brace(assembled.map.start().file, unpaired))
}

/// naga tells of its limit without a place.
fn too_deep(found: &ParseError, assembled: &Assembled) -> Option<Diagnostic> {
    if found.message() != "internal WGSL front end error" || !found.notes().any(|note| note.contains("recursion")) {
        return None;
    }
    let files = assembled.map.files().zip(&assembled.texts);
    let deepest = files.filter_map(|(file, (_, scan))| Some((file, limits::deepest(&scan.tokens)?)));
    let span = match deepest.max_by_key(|(_, (_, depth))| *depth) {
        Some((file, (token, _))) => Span::new(file, token.start, token.end),
        None => assembled.map.start(),
    };
    Some(error("this text nests deeper than the parser can follow").at(span, "the deepest bracket"))
}

/// If the error is the first word of a file and the file before it does not end as a declaration
/// does, the place is the end of that file.
fn missing_end(span: Span, assembled: &Assembled) -> Option<Span> {
    let (before, unit) = assembled.map.file_before(span)?;
    let is_part = |start: usize| start < span.start as usize;
    let (text, scan) = &assembled.texts[unit];
    if scan.tokens.iter().any(|t| is_part(t.start) && !is_blanked(t.start, text)) {
        return None;
    }
    let (text, scan) = &assembled.texts[before];
    let last = scan.tokens.last().filter(|t| !t.is(b';') && !t.is(b'}') && !is_blanked(t.start, text))?;
    Some(Span::new(assembled.map.file(before), last.start, last.end))
}

/// Whether the line of a token is an import.
fn is_blanked(at: usize, text: &str) -> bool {
    let line = text[..at].rfind('\n').map_or(0, |end| end + 1);
    text[line..].trim_start().starts_with('#')
}

fn error(message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(Code::SHADER, message)
}

/// The last touch: how the file at fault came in.
fn finish(diagnostic: Diagnostic, assembled: &Assembled) -> Diagnostic {
    assembled.map.imported(diagnostic)
}

/// An error of naga's with its causes, as one lower-case text.
pub(super) fn sentence(error: &dyn std::error::Error) -> String {
    let mut parts = vec![sentence_of(&error.to_string())];
    let mut source = error.source();
    while let Some(cause) = source {
        let text = sentence_of(&cause.to_string());
        if parts.last() != Some(&text) {
            parts.push(text);
        }
        source = cause.source();
    }
    parts.join(": ")
}

/// naga's words in this program's manner: lower case, no full stop, no handles such as `[4]`.
fn sentence_of(text: &str) -> String {
    let text = without_handles(text.trim().trim_end_matches('.'));
    let mut chars = text.chars();
    match (chars.next(), chars.next()) {
        (Some(first), Some(second)) if first.is_uppercase() && !second.is_uppercase() => {
            first.to_lowercase().chain(text.chars().skip(1)).collect()
        }
        _ => text,
    }
}

/// Leaves out numbers in square brackets, which is how naga shows its handles.
fn without_handles(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('[') {
        let digits = rest[at + 1..].bytes().take_while(u8::is_ascii_digit).count();
        let end = at + 1 + digits;
        if digits > 0 && rest[end..].starts_with(']') {
            out.push_str(rest[..at].trim_end());
            rest = &rest[end + 1..];
        } else {
            out.push_str(&rest[..at + 1]);
            rest = &rest[at + 1..];
        }
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_are_lower_case_and_without_handles() {
        assert_eq!(sentence_of("Expression [4] is invalid."), "expression is invalid");
        assert_eq!(sentence_of("LHS expression"), "LHS expression");
        assert_eq!(sentence_of("argument [1] to array[N] of [a]"), "argument to array[N] of [a]");
        assert_eq!(sentence_of(""), "");
    }
}
