//! Why a file could not be read, and where in it.

use std::fmt;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Bytes from the start of the file.
    Byte(usize),
    /// Bytes from the start of what a compressed file unpacks to.
    UnpackedByte(usize),
    /// Line and column of a text, both from 1; the column counts characters.
    Line { line: usize, column: usize },
}

impl Place {
    /// The line and column of a byte offset.
    pub(super) fn in_text(bytes: &[u8], offset: usize) -> Self {
        let before = bytes.get(..offset).unwrap_or(bytes);
        let line_start = before.iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
        let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
        // A mark at the start of a text is no character of it.
        let column = String::from_utf8_lossy(&before[line_start..]).chars().filter(|c| *c != '\u{feff}').count() + 1;
        Self::Line { line, column }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Byte(at) => write!(f, "byte {at}"),
            Self::UnpackedByte(at) => write!(f, "byte {at} of the unpacked data"),
            Self::Line { line, column } => write!(f, "line {line}, column {column}"),
        }
    }
}

/// A file that cannot be read as particles: what was expected, what was found, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    pub message: String,
    pub place: Option<Place>,
    pub hint: Option<String>,
}

impl ReadError {
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), place: None, hint: None }
    }

    pub(super) fn at(mut self, place: Place) -> Self {
        self.place = Some(place);
        self
    }

    /// Gives the place if there is none yet. Places are worked out late, since a line's number
    /// costs a look at the whole file before it.
    pub(super) fn or_at(mut self, place: impl FnOnce() -> Place) -> Self {
        self.place = self.place.or_else(|| Some(place()));
        self
    }

    pub(super) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for ReadError {}

/// A word from a file as a message may show it: quoted, clipped, without control characters.
pub(super) fn shown(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(&word[..word.len().min(LONGEST)]);
    let clipped = if word.len() > LONGEST { "…" } else { "" };
    format!("`{}{clipped}`", text.escape_debug())
}

/// `1 particle`, `2 particles`.
pub(super) fn counted(count: usize, singular: &str) -> String {
    format!("{count} {singular}{}", if count == 1 { "" } else { "s" })
}
