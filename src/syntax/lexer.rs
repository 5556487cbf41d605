//! Text into tokens with byte ranges. Comments and white space vanish here.

use std::collections::BTreeSet;
use std::ops::Range;

use super::literal::{self, Fault};

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub kind: TokenKind,
    pub range: Range<usize>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum TokenKind {
    Ident(String),
    Int(i64),
    Float(f64),
    /// The value, the range between the quotes, and whether there are no escapes.
    Str(String, Range<usize>, bool),
    Char(char),
    Open(Bracket),
    Close(Bracket),
    Comma,
    Colon,
    /// Any other character.
    Other(char),
    /// A literal with a mistake in it, which was reported.
    Bad,
    End,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bracket {
    Round,
    Square,
    Curly,
}

impl Bracket {
    pub(super) fn open(self) -> char {
        match self {
            Bracket::Round => '(',
            Bracket::Square => '[',
            Bracket::Curly => '{',
        }
    }

    pub(super) fn close(self) -> char {
        match self {
            Bracket::Round => ')',
            Bracket::Square => ']',
            Bracket::Curly => '}',
        }
    }
}

impl TokenKind {
    pub(super) fn describe(&self) -> String {
        match self {
            TokenKind::Ident(name) => format!("`{name}`"),
            TokenKind::Int(_) | TokenKind::Float(_) => "a number".into(),
            TokenKind::Str(..) => "a string".into(),
            TokenKind::Char(_) => "a character".into(),
            TokenKind::Open(bracket) => format!("`{}`", bracket.open()),
            TokenKind::Close(bracket) => format!("`{}`", bracket.close()),
            TokenKind::Comma => "`,`".into(),
            TokenKind::Colon => "`:`".into(),
            TokenKind::Other(c) => format!("`{c}`"),
            TokenKind::Bad => "something unreadable".into(),
            TokenKind::End => "the end of the file".into(),
        }
    }

    /// Whether a value can begin with it.
    pub(super) fn starts_value(&self) -> bool {
        !matches!(
            self,
            TokenKind::Close(_) | TokenKind::Comma | TokenKind::Colon | TokenKind::Other(_) | TokenKind::End
        )
    }
}

/// A text as tokens, closed by [`TokenKind::End`].
pub(super) struct Lexed {
    pub tokens: Vec<Token>,
    pub faults: Vec<Fault>,
    /// Lines (as byte ranges) whose strings never end: nothing more is said about them.
    pub broken_lines: Vec<Range<usize>>,
}

/// Splits a text. A string without its closing quote takes the rest of the file with it, so the
/// likely culprit, the first string that runs over a line's end, is cut at the end of its line,
/// and the text is split again.
pub(super) fn lex(text: &str) -> Lexed {
    let mut cuts: BTreeSet<usize> = BTreeSet::new();
    loop {
        let mut lexer = Lexer { text, at: 0, tokens: Vec::new(), faults: Vec::new(), cuts: &cuts, runaway: None };
        lexer.run();
        match lexer.runaway {
            Some(start) if cuts.len() < 64 => _ = cuts.insert(start),
            _ => {
                let broken_lines = cuts.iter().map(|start| line_of(text, *start)).collect();
                return Lexed { tokens: lexer.tokens, faults: lexer.faults, broken_lines };
            }
        }
    }
}

fn line_of(text: &str, at: usize) -> Range<usize> {
    let start = text[..at].rfind('\n').map_or(0, |i| i + 1);
    start..line_end(text, at)
}

fn line_end(text: &str, at: usize) -> usize {
    text[at..].find('\n').map_or(text.len(), |i| at + i)
}

struct Lexer<'a> {
    text: &'a str,
    at: usize,
    tokens: Vec<Token>,
    faults: Vec<Fault>,
    /// Opening quotes whose strings end with their line.
    cuts: &'a BTreeSet<usize>,
    /// The string to blame for one that never ends.
    runaway: Option<usize>,
}

impl<'a> Lexer<'a> {
    fn run(&mut self) {
        if self.rest().starts_with('\u{feff}') {
            self.faults.push(
                Fault::new(0..3, "the file begins with a byte order mark", "this character cannot be seen")
                    .hint("save the file as UTF-8 without a byte order mark"),
            );
            self.at += 3;
        }
        while self.runaway.is_none() {
            self.skip_space();
            let start = self.at;
            let Some(c) = self.rest().chars().next() else { break };
            let kind = self.token(c);
            debug_assert!(self.at > start);
            self.tokens.push(Token { kind, range: start..self.at });
        }
        self.tokens.push(Token { kind: TokenKind::End, range: self.text.len()..self.text.len() });
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn skip_space(&mut self) {
        loop {
            let rest = self.rest();
            let trimmed = rest.trim_start_matches(is_space);
            let blank = rest.len() - trimmed.len();
            let comment = if trimmed.starts_with("//") {
                line_end(trimmed, 0)
            } else if trimmed.starts_with("/*") {
                match block_comment(trimmed) {
                    Some(length) => length,
                    None => {
                        let at = self.at + blank;
                        self.faults.push(
                            Fault::new(at..at + 2, "a comment is never closed", "this opens it")
                                .hint("close it with `*/`; comments nest, so each `/*` needs its own"),
                        );
                        trimmed.len()
                    }
                }
            } else {
                0
            };
            self.at += blank + comment;
            if comment == 0 {
                return;
            }
        }
    }

    fn token(&mut self, c: char) -> TokenKind {
        let rest = &self.text[self.at..];
        match c {
            '(' => self.punctuation(TokenKind::Open(Bracket::Round)),
            '[' => self.punctuation(TokenKind::Open(Bracket::Square)),
            '{' => self.punctuation(TokenKind::Open(Bracket::Curly)),
            ')' => self.punctuation(TokenKind::Close(Bracket::Round)),
            ']' => self.punctuation(TokenKind::Close(Bracket::Square)),
            '}' => self.punctuation(TokenKind::Close(Bracket::Curly)),
            ',' => self.punctuation(TokenKind::Comma),
            ':' => self.punctuation(TokenKind::Colon),
            '"' => self.string(),
            '\'' => self.literal(literal::character),
            'r' if rest[1..].trim_start_matches('#').starts_with('"') => self.literal(literal::raw_string),
            'b' if ["b\"", "b'", "br\"", "br#"].iter().any(|p| rest.starts_with(p)) => {
                self.literal(literal::byte_string)
            }
            '0'..='9' | '+' | '-' | '.' => self.literal(literal::number),
            'a'..='z' | 'A'..='Z' | '_' => {
                let length = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
                self.at += length;
                TokenKind::Ident(rest[..length].into())
            }
            c => {
                self.at += c.len_utf8();
                TokenKind::Other(c)
            }
        }
    }

    fn punctuation(&mut self, kind: TokenKind) -> TokenKind {
        self.at += 1;
        kind
    }

    fn literal(&mut self, read: fn(&str, usize) -> (TokenKind, usize, Option<Fault>)) -> TokenKind {
        let (kind, length, fault) = read(self.text, self.at);
        self.faults.extend(fault);
        self.at += length.max(1);
        kind
    }

    fn string(&mut self) -> TokenKind {
        let start = self.at;
        if self.cuts.contains(&start) {
            return self.cut_string(start);
        }
        let (kind, length, fault) = literal::string(self.text, start);
        if let Some(length) = length {
            self.faults.extend(fault);
            self.at += length;
            return kind;
        }
        let spread = |t: &&Token| {
            matches!(t.kind, TokenKind::Str(..) | TokenKind::Bad)
                && self.text[t.range.clone()].starts_with('"')
                && self.text[t.range.clone()].contains('\n')
        };
        self.runaway = Some(self.tokens.iter().find(spread).map_or(start, |t| t.range.start));
        self.at = self.text.len();
        TokenKind::Bad
    }

    /// A string that is taken to end with its line, before the brackets and commas there.
    fn cut_string(&mut self, start: usize) -> TokenKind {
        let line = &self.text[start..line_end(self.text, start)];
        let kept = line.trim_end_matches(|c: char| c.is_whitespace() || ",)]}".contains(c)).len().max(1);
        self.faults.push(
            Fault::new(start..start + 1, "a string is never closed", "this quote has no partner")
                .hint("close the string with `\"`, or write `\\\"` for a quote inside it"),
        );
        self.at += kept;
        TokenKind::Bad
    }
}

fn block_comment(text: &str) -> Option<usize> {
    let (bytes, mut depth, mut i) = (text.as_bytes(), 0usize, 0);
    while i < bytes.len() {
        match (bytes[i], bytes.get(i + 1)) {
            (b'/', Some(b'*')) => (depth, i) = (depth + 1, i + 2),
            (b'*', Some(b'/')) => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            return Some(i);
        }
    }
    None
}

fn is_space(c: char) -> bool {
    matches!(
        c,
        ' ' | '\t' | '\n' | '\r' | '\x0b' | '\x0c' | '\u{85}' | '\u{200e}' | '\u{200f}' | '\u{2028}' | '\u{2029}'
    )
}
