//! Numbers, strings and characters. Each reader takes the whole text and the offset where the
//! literal begins, and gives a token, how many bytes it took, and what is wrong with it.

use std::ops::Range;

use super::lexer::TokenKind;

/// A mistake in a literal, before it becomes a diagnostic.
#[derive(Debug)]
pub(super) struct Fault {
    pub range: Range<usize>,
    pub message: String,
    pub label: String,
    /// A second place, with what is to be said of it.
    pub see: Option<(Range<usize>, String)>,
    pub hint: Option<String>,
}

impl Fault {
    pub(super) fn new(range: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Self {
        Self { range, message: message.into(), label: label.into(), see: None, hint: None }
    }

    pub(super) fn see(mut self, range: Range<usize>, label: impl Into<String>) -> Self {
        self.see = Some((range, label.into()));
        self
    }

    pub(super) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

type Read = (TokenKind, usize, Option<Fault>);

fn bad(length: usize, fault: Fault) -> Read {
    (TokenKind::Bad, length, Some(fault))
}

/// `12`, `-3.5e-2`, `0xff`, `1_000`, `+inf`.
pub(super) fn number(text: &str, start: usize) -> Read {
    let rest = &text[start..];
    let length = number_length(rest);
    let (word, range) = (&rest[..length], start..start + length);
    let digits = word.trim_start_matches(['+', '-']);
    let is_negative = word.starts_with('-');
    let refuse = |label: &str| bad(length, Fault::new(range.clone(), format!("`{word}` is not a number"), label));
    if word.len() - digits.len() > 1 {
        return refuse("one sign at most");
    }
    match digits {
        "" => return refuse("a sign without digits"),
        "inf" => {
            return (TokenKind::Float(if is_negative { f64::NEG_INFINITY } else { f64::INFINITY }), length, None);
        }
        "NaN" => return (TokenKind::Float(f64::NAN), length, None),
        _ => {}
    }
    let radix = match digits.get(..2) {
        Some("0x") => 16,
        Some("0o") => 8,
        Some("0b") => 2,
        _ => 10,
    };
    if radix == 10 && digits.contains("..") {
        return refuse("ranges are not supported");
    }
    let suffixes = ["i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64", "f32", "f64"];
    if radix != 16
        && let Some(suffix) = suffixes.iter().find(|s| digits.ends_with(**s))
    {
        return refuse(&format!("numbers have no type suffix here: leave out `{suffix}`"));
    }
    if radix == 10 && digits.contains(['.', 'e', 'E']) {
        return match decimal(digits) {
            Some(value) if value.is_finite() => {
                (TokenKind::Float(if is_negative { -value } else { value }), length, None)
            }
            Some(_) => refuse("it is too large for a 64-bit float"),
            None => refuse("digits, at most one `.` and one exponent are expected"),
        };
    }
    match integer(&digits[if radix == 10 { 0 } else { 2 }..], radix, is_negative) {
        Ok(value) => (TokenKind::Int(value), length, None),
        Err(label) => refuse(label),
    }
}

/// How far a number goes: letters and digits, and signs after an exponent.
fn number_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let hex = rest.trim_start_matches(['+', '-']).starts_with("0x");
    let mut i = 0;
    while i < bytes.len() {
        let keeps = match bytes[i] {
            b'+' | b'-' => {
                i == 0 || matches!(bytes[i - 1], b'+' | b'-') || (!hex && matches!(bytes[i - 1], b'e' | b'E'))
            }
            c => c.is_ascii_alphanumeric() || c == b'_' || c == b'.',
        };
        if !keeps {
            break;
        }
        i += 1;
    }
    i
}

/// As `ron`: underscores only after a digit or an exponent's letter.
fn decimal(digits: &str) -> Option<f64> {
    let (mut plain, mut may_underscore) = (String::with_capacity(digits.len()), false);
    for c in digits.chars() {
        match c {
            '_' if may_underscore => continue,
            '0'..='9' | 'e' | 'E' => may_underscore = true,
            '.' => may_underscore = false,
            '+' | '-' => {}
            _ => return None,
        }
        plain.push(c);
    }
    plain.parse().ok()
}

fn integer(digits: &str, radix: u32, is_negative: bool) -> Result<i64, &'static str> {
    if digits.starts_with('_') {
        return Err("an underscore may stand between digits only");
    }
    if digits.is_empty() {
        return Err("digits are missing");
    }
    let mut value: i64 = 0;
    for c in digits.chars().filter(|c| *c != '_') {
        let digit = i64::from(c.to_digit(radix).ok_or("not all of it are digits")?);
        value = value
            .checked_mul(i64::from(radix))
            .and_then(|v| if is_negative { v.checked_sub(digit) } else { v.checked_add(digit) })
            .ok_or("it does not fit in 64 bits")?;
    }
    Ok(value)
}

/// `"..."`, with escapes. The length is absent if the string never ends.
pub(super) fn string(text: &str, start: usize) -> (TokenKind, Option<usize>, Option<Fault>) {
    let mut value = String::new();
    let (mut at, mut exact, mut fault) = (start + 1, true, None);
    loop {
        let rest = &text[at..];
        let Some(stop) = rest.find(['"', '\\']) else { return (TokenKind::Bad, None, None) };
        value.push_str(&rest[..stop]);
        at += stop;
        if text[at..].starts_with('"') {
            let inner = start + 1..at;
            let kind = if fault.is_none() { TokenKind::Str(value, inner, exact) } else { TokenKind::Bad };
            return (kind, Some(at + 1 - start), fault);
        }
        exact = false;
        match escape(&text[at + 1..], false) {
            Ok((c, length)) => {
                value.extend(c);
                at += 1 + length;
            }
            Err(label) => {
                let length = text[at + 1..].chars().next().map_or(0, char::len_utf8);
                fault = fault.or_else(|| Some(bad_escape(at..at + 1 + length, label)));
                at += 1 + length;
            }
        }
    }
}

fn bad_escape(range: Range<usize>, label: &str) -> Fault {
    Fault::new(range, "an escape in a string is not one of RON's", label).hint(
        "RON has \\n, \\r, \\t, \\0, \\\\, \\\", \\', \\xHH and \\u{HHHH}; write \\\\ for a backslash, or use r\"...\"",
    )
}

/// What follows a backslash: the character, if any, and how many bytes it took.
fn escape(rest: &str, in_char: bool) -> Result<(Option<char>, usize), &'static str> {
    let simple = |c| Ok((Some(c), 1));
    match rest.as_bytes().first() {
        Some(b'\'') => simple('\''),
        Some(b'"') => simple('"'),
        Some(b'\\') => simple('\\'),
        Some(b'n') => simple('\n'),
        Some(b'r') => simple('\r'),
        Some(b't') => simple('\t'),
        Some(b'0') => simple('\0'),
        Some(b'x') => byte_escape(rest, in_char),
        Some(b'u') => unicode_escape(rest),
        Some(b'\n' | b'\r') if !in_char => {
            let line_end = if rest.starts_with("\r\n") {
                2
            } else if rest.starts_with('\n') {
                1
            } else {
                return Err("a backslash before a lone carriage return");
            };
            let after = rest[line_end..].trim_start_matches([' ', '\t', '\n', '\r']);
            Ok((None, rest.len() - after.len()))
        }
        _ => Err("no such escape"),
    }
}

/// `\xHH`; in strings up to four of them make one character.
fn byte_escape(rest: &str, in_char: bool) -> Result<(Option<char>, usize), &'static str> {
    let hex = |at: usize| rest.get(at..at + 2).filter(|h| h.bytes().all(|b| b.is_ascii_hexdigit()));
    let mut bytes = Vec::with_capacity(4);
    let mut at = 1;
    loop {
        let digits = hex(at).ok_or("two hexadecimal digits are expected after `\\x`")?;
        bytes.push(u8::from_str_radix(digits, 16).map_err(|_| "two hexadecimal digits are expected")?);
        at += 2;
        if let Ok(text) = std::str::from_utf8(&bytes) {
            return Ok((text.chars().next(), at));
        }
        if in_char || bytes.len() == 4 || !rest[at..].starts_with("\\x") {
            return Err("these bytes are not a character of UTF-8");
        }
        at += 2;
    }
}

fn unicode_escape(rest: &str) -> Result<(Option<char>, usize), &'static str> {
    let digits = rest.strip_prefix("u{").and_then(|r| r.split_once('}')).map(|(digits, _)| digits);
    let digits = digits
        .filter(|d| (1..=6).contains(&d.len()) && d.bytes().all(|b| b.is_ascii_hexdigit()))
        .ok_or("one to six hexadecimal digits in braces are expected after `\\u`")?;
    let code = u32::from_str_radix(digits, 16).map_err(|_| "too large")?;
    let c = char::from_u32(code).ok_or("this is no character of Unicode")?;
    Ok((Some(c), digits.len() + 3))
}

/// `r"..."`, `r#"..."#`.
pub(super) fn raw_string(text: &str, start: usize) -> Read {
    let rest = &text[start + 1..];
    let hashes = rest.len() - rest.trim_start_matches('#').len();
    let inner = start + 1 + hashes + 1;
    let end = format!("\"{}", "#".repeat(hashes));
    match text[inner..].find(&end) {
        Some(length) => {
            let range = inner..inner + length;
            let kind = TokenKind::Str(text[range.clone()].into(), range, true);
            (kind, inner + length + end.len() - start, None)
        }
        None => bad(
            text.len() - start,
            Fault::new(start..inner, "a raw string is never closed", "this opens it")
                .hint(format!("close it with `{end}`")),
        ),
    }
}

pub(super) fn byte_string(text: &str, start: usize) -> Read {
    let rest = &text[start..];
    let length = match rest.as_bytes().get(1) {
        Some(b'\'') => character(text, start + 1).1 + 1,
        Some(b'"') => string(text, start + 1).1.map_or(rest.len(), |l| l + 1),
        _ => raw_string(text, start + 1).1 + 1,
    };
    let shown = start..start + length.min(rest.find('\n').unwrap_or(rest.len())).max(1);
    bad(length, Fault::new(shown, "byte strings are not supported", "use a string without the `b`"))
}

/// `'c'`.
pub(super) fn character(text: &str, start: usize) -> Read {
    let rest = &text[start + 1..];
    let read = match rest.chars().next() {
        Some('\\') => escape(&rest[1..], true).map(|(c, length)| (c, length + 1)),
        Some(c) => Ok((Some(c), c.len_utf8())),
        None => Err("a character is expected here"),
    };
    let line = rest.find('\n').unwrap_or(rest.len());
    match read {
        Ok((Some(c), length)) if rest[length..].starts_with('\'') => (TokenKind::Char(c), length + 2, None),
        _ => {
            // Take a word in single quotes as one mistake.
            let length = rest[..line].find('\'').map_or(1, |i| i + 2);
            bad(
                length,
                Fault::new(
                    start..start + length,
                    "single quotes hold exactly one character",
                    "this is not one character",
                )
                .hint("strings stand in double quotes"),
            )
        }
    }
}
