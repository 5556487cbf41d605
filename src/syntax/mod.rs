//! RON as a tree with spans: what graphs and scenes are read from.
//!
//! [`parse`] takes a text and gives a tree whatever is wrong with it: a part that cannot be read
//! becomes [`Kind::Invalid`], which was reported already, and everything around it stands. So one
//! run tells all mistakes of a file. [`Decoder`] turns nodes into typed values.
//!
//! The reference is the `ron` crate: what is accepted here means the same there. Left out, with
//! an error that says so, is what no file here needs: byte strings, ranges, raw identifiers,
//! identifiers beyond ASCII, type suffixes of numbers, integers beyond 64 bits. Stricter than
//! `ron` on purpose: a field or key that is said twice is an error.

mod brackets;
mod decode;
mod lexer;
mod literal;
mod parser;
mod word;

pub use decode::{Decoder, Fields};
pub use word::first_word;

use std::path::Path;

use crate::diagnostic::{Code, Diagnostic, Diagnostics, FileId, Sources, Span};

/// How deep brackets may nest; a little less than in `ron`.
pub const MAX_DEPTH: usize = 60;

/// A value and where it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Sp<T> {
    pub value: T,
    pub span: Span,
}

/// A RON value with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub span: Span,
    pub kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    Bool(bool),
    Int(i64),
    Float(f64),
    Str(Str),
    Char(char),
    /// `[...]`
    List(Vec<Node>),
    /// `{...}`
    Map(Vec<(Node, Node)>),
    /// `Word`, `Word(...)` or `(...)`.
    Tagged(Tagged),
    /// Something that could not be read and was reported.
    Invalid,
}

/// A string.
#[derive(Clone, Debug, PartialEq)]
pub struct Str {
    pub value: String,
    /// What stands between the quotes.
    pub inner: Span,
    /// There are no escapes, so that offsets in `value` are offsets from the start of `inner`.
    pub exact: bool,
}

/// A word, a bracket or both.
#[derive(Clone, Debug, PartialEq)]
pub struct Tagged {
    pub name: Option<Sp<String>>,
    pub body: Body,
    /// Nothing in it was unreadable, so that what is not there was not written.
    pub is_whole: bool,
    /// The word and the opening bracket, for labels that should not cover many lines.
    pub head: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A bare word.
    Unit,
    /// `(a, b)`, also `()`.
    Items(Vec<Node>),
    /// `(x: a, y: b)`.
    Fields(Vec<(Sp<String>, Node)>),
}

impl Tagged {
    /// Whether it has a field of that name.
    pub fn has(&self, field: &str) -> bool {
        matches!(&self.body, Body::Fields(fields) if fields.iter().any(|(name, _)| name.value == field))
    }
}

impl Node {
    /// What a message calls it: "a string", "the word `Auto`".
    pub fn describe(&self) -> String {
        match &self.kind {
            Kind::Bool(b) => format!("`{b}`"),
            Kind::Int(i) => format!("the number {i}"),
            Kind::Float(x) => format!("the number {x:?}"),
            Kind::Str(_) => "a string".into(),
            Kind::Char(_) => "a character".into(),
            Kind::List(_) => "a list".into(),
            Kind::Map(_) => "a map".into(),
            Kind::Invalid => "something unreadable".into(),
            Kind::Tagged(Tagged { name, body, .. }) => match (name, body) {
                (Some(name), Body::Unit) => format!("the word `{}`", name.value),
                (Some(name), _) => format!("`{}(...)`", name.value),
                (None, Body::Fields(_)) => "a bracket of fields".into(),
                (None, _) => "a tuple".into(),
            },
        }
    }

    pub fn as_str(&self) -> Option<&Str> {
        match &self.kind {
            Kind::Str(s) => Some(s),
            _ => None,
        }
    }

    pub fn as_tagged(&self) -> Option<&Tagged> {
        match &self.kind {
            Kind::Tagged(t) => Some(t),
            _ => None,
        }
    }

    /// The name, if it is a bare word.
    pub fn as_word(&self) -> Option<&Sp<String>> {
        match &self.kind {
            Kind::Tagged(Tagged { name: Some(name), body: Body::Unit, .. }) => Some(name),
            _ => None,
        }
    }

    /// A span for a label about the whole: the first line's worth of a bracket.
    pub fn head(&self) -> Span {
        self.as_tagged().map_or(self.span, |t| t.head)
    }

    /// Whether it was reported already.
    pub fn is_invalid(&self) -> bool {
        self.kind == Kind::Invalid
    }
}

/// Reads a file of [`Sources`] as one RON value and reports every mistake of form. Without
/// errors the tree has no [`Kind::Invalid`]; `None` means that nothing could be made out.
pub fn parse(sources: &Sources, file: FileId, diagnostics: &mut Diagnostics) -> Option<Node> {
    let text = sources.text(file);
    if u32::try_from(text.len()).is_err() {
        diagnostics
            .push(Diagnostic::error(Code::FILE_UNREADABLE, format!("`{}` is larger than 4 GiB", sources.path(file))));
        return None;
    }
    parser::parse(text, file, diagnostics)
}

/// Registers the bytes of a file as text.
///
/// # Errors
/// If the bytes are not UTF-8; the diagnostic names the line and the byte offset, and points at
/// the line in a copy whose unreadable bytes are replaced.
pub fn add_bytes(sources: &mut Sources, path: &Path, bytes: &[u8]) -> Result<FileId, Diagnostic> {
    let shown = path.display().to_string();
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(sources.add(shown, text)),
        Err(error) => {
            let offset = error.valid_up_to();
            let file = sources.add(shown.clone(), String::from_utf8_lossy(bytes).into_owned());
            let byte = bytes.get(offset).copied().unwrap_or_default();
            Err(Diagnostic::error(Code::FILE_UNREADABLE, format!("`{shown}` is not text: byte {offset} is not UTF-8"))
                .at(
                    Span::new(file, offset, offset + '\u{fffd}'.len_utf8()),
                    format!("here is the byte 0x{byte:02x}, which no UTF-8 text has at this place"),
                )
                .hint("save the file as UTF-8"))
        }
    }
}
