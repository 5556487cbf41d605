//! The words and marks of a WGSL text with their places, comments skipped. Just enough to find
//! imports, directives and declarations; naga does the parsing.

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// An identifier, keyword or number (but for the sign of its exponent).
    Word,
    /// A string on one line, quotes included. WGSL has none; imports do.
    Text,
    /// Any other single byte.
    Mark(u8),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub kind: Kind,
    /// Byte range in the text.
    pub start: usize,
    pub end: usize,
    /// Nothing but blanks and comments stands before it on its line.
    pub starts_line: bool,
}

/// A text's tokens.
#[derive(Clone, Debug, Default)]
pub(super) struct Scan {
    pub tokens: Vec<Token>,
    /// Where a `/*` stands that is never closed.
    pub open_comment: Option<usize>,
}

/// Where brackets do not pair up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unpaired {
    /// The token opens a bracket that nothing closes.
    Open(Token),
    /// The token closes a bracket that nothing opened.
    Close(Token),
}

pub(super) fn scan(text: &str) -> Scan {
    let bytes = text.as_bytes();
    let mut out = Scan::default();
    let (mut at, mut starts_line) = (0, true);
    while let Some(&byte) = bytes.get(at) {
        let rest = &bytes[at..];
        match byte {
            b'\n' => {
                starts_line = true;
                at += 1;
            }
            b if b.is_ascii_whitespace() || b == 0x0b => at += 1,
            b'/' if rest.starts_with(b"//") => at = line_end(text, at),
            b'/' if rest.starts_with(b"/*") => match comment_end(bytes, at) {
                Some(end) => at = end,
                None => {
                    out.open_comment = Some(at);
                    break;
                }
            },
            _ => {
                let (kind, length) = token(rest);
                out.tokens.push(Token { kind, start: at, end: at + length, starts_line });
                starts_line = false;
                at += length;
            }
        }
    }
    out
}

fn token(rest: &[u8]) -> (Kind, usize) {
    // Any byte of a multi-byte character counts as part of a word; naga knows which may be.
    let is_word = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_' || *b >= 0x80;
    let is_number = rest[0].is_ascii_digit();
    let count = rest.iter().take_while(|b| is_word(b) || (is_number && **b == b'.')).count();
    if count > 0 {
        return (Kind::Word, count);
    }
    if rest[0] == b'"' {
        let end = rest[1..].iter().position(|b| matches!(b, b'"' | b'\n' | b'\r'));
        if let Some(end) = end.filter(|end| rest[1 + end] == b'"') {
            return (Kind::Text, end + 2);
        }
    }
    (Kind::Mark(rest[0]), 1)
}

/// The end of a `//` comment: any of the line breaks that WGSL knows.
fn line_end(text: &str, start: usize) -> usize {
    let is_break = |c: char| matches!(c, '\u{a}'..='\u{d}' | '\u{85}' | '\u{2028}' | '\u{2029}');
    text[start..].find(is_break).map_or(text.len(), |at| start + at)
}

/// The end of a `/* */` comment, which nest.
fn comment_end(bytes: &[u8], start: usize) -> Option<usize> {
    let (mut depth, mut at) = (0, start);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

impl Token {
    pub fn text<'a>(&self, source: &'a str) -> &'a str {
        &source[self.start..self.end]
    }

    pub fn is(&self, mark: u8) -> bool {
        self.kind == Kind::Mark(mark)
    }
}

impl Scan {
    /// The first curly bracket that has no partner in this text.
    pub fn unpaired_brace(&self) -> Option<Unpaired> {
        let mut open = Vec::new();
        for token in &self.tokens {
            if token.is(b'{') {
                open.push(token);
            } else if token.is(b'}') && open.pop().is_none() {
                return Some(Unpaired::Close(*token));
            }
        }
        open.pop().map(|token| Unpaired::Open(*token))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(source: &str) -> Vec<&str> {
        scan(source).tokens.iter().map(|t| t.text(source)).collect()
    }

    #[test]
    fn comments_are_skipped_and_nest() {
        assert_eq!(texts("a // b\nc /* d /* e */ f */ g"), ["a", "c", "g"]);
        assert_eq!(texts("a // b\u{2028}c"), ["a", "\u{2028}c"]);
        assert_eq!(texts("a.x+1.5f"), ["a", ".", "x", "+", "1.5f"]);
        assert_eq!(scan("a /* b /* c */").open_comment, Some(2));
        assert_eq!(scan("/*/").open_comment, Some(0));
    }

    #[test]
    fn strings_end_on_their_line() {
        assert_eq!(texts("#import \"a b\" c"), ["#", "import", "\"a b\"", "c"]);
        assert_eq!(texts("\"a\nb\""), ["\"", "a", "b", "\""]);
    }

    #[test]
    fn only_the_first_token_starts_a_line() {
        let starts: Vec<bool> = scan("a b\n /* c */ d e").tokens.iter().map(|t| t.starts_line).collect();
        assert_eq!(starts, [true, false, true, false]);
    }

    #[test]
    fn unpaired_braces_are_found() {
        let found = |source| scan(source).unpaired_brace();
        assert_eq!(found("{ { } }"), None);
        assert!(matches!(found("{ { }"), Some(Unpaired::Open(t)) if t.start == 0));
        assert!(matches!(found("{ } }"), Some(Unpaired::Close(t)) if t.start == 4));
    }
}
