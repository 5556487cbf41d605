//! A place in a file that moves on: words, lines and bytes, each checked against what is left.

use super::error::{Place, ReadError, counted, shown};
use super::values::{Kind, Values};

/// With which some programs begin a text in UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// A cursor at the start of a text, behind the mark that some programs begin one with.
    pub fn of_text(bytes: &'a [u8]) -> Self {
        Self { bytes, at: if bytes.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 } }
    }

    /// A cursor that begins at a byte of a file.
    pub fn starting(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    pub fn offset(&self) -> usize {
        self.at
    }

    pub fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// The next line without its end, or none at the end of the file.
    pub fn line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&b| b == b'\n');
        self.at += end.map_or(rest.len(), |end| end + 1);
        let line = &rest[..end.unwrap_or(rest.len())];
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    pub fn skip_space(&mut self) {
        let rest = self.rest();
        self.at += rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
    }

    /// The next word between white space, over line ends.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        self.skip_space();
        self.word_here()
    }

    /// The next word on this line.
    pub fn word_on_line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        self.at += rest.iter().position(|&b| b != b' ' && b != b'\t').unwrap_or(rest.len());
        self.word_here()
    }

    fn word_here(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += end;
        (end > 0).then(|| &rest[..end])
    }

    /// What follows on this line; moves to the next.
    pub fn finish_line(&mut self) -> &'a [u8] {
        self.line().unwrap_or_default()
    }

    /// Whether what follows begins with `text`, in any case.
    pub fn sees(&self, text: &str) -> bool {
        self.rest().get(..text.len()).is_some_and(|start| start.eq_ignore_ascii_case(text.as_bytes()))
    }

    /// The next `count` bytes, which are `what`.
    pub fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], ReadError> {
        let rest = self.rest();
        let Some(taken) = rest.get(..count) else {
            return Err(self.byte_error(format!(
                "{what}: expected {}, found {} before the end of the file",
                counted(count, "byte"),
                rest.len()
            )));
        };
        self.at += count;
        Ok(taken)
    }

    /// The next `count` numbers of a text.
    pub fn numbers(&mut self, kind: Kind, count: usize, what: &str) -> Result<Values, ReadError> {
        self.check_words(count, what)?;
        let mut values = Values::empty(kind);
        for index in 0..count {
            let word = self.expect_number(index, count, what)?;
            if !values.push_text(word) {
                let message = format!("{what}: expected a number of type {}, found {}", kind.name(), shown(word));
                return Err(self.text_error_before(word, message));
            }
        }
        Ok(values)
    }

    /// Skips `count` words, which are numbers of no interest.
    pub fn skip_words(&mut self, count: usize, what: &str) -> Result<(), ReadError> {
        self.check_words(count, what)?;
        for index in 0..count {
            self.expect_number(index, count, what)?;
        }
        Ok(())
    }

    /// Each number takes at least a digit and a space, so a lying count is found out early.
    fn check_words(&self, count: usize, what: &str) -> Result<(), ReadError> {
        let most = self.rest().len().div_ceil(2);
        if count > most {
            return Err(self.text_error(format!(
                "{what}: expected {}, but the rest of the file can hold at most {most}",
                counted(count, "number")
            )));
        }
        Ok(())
    }

    fn expect_number(&mut self, index: usize, count: usize, what: &str) -> Result<&'a [u8], ReadError> {
        match self.word() {
            Some(word) => Ok(word),
            None => Err(self.text_error(format!(
                "{what}: expected {}, found {index} before the end of the file",
                counted(count, "number")
            ))),
        }
    }

    /// An error at this byte.
    pub fn byte_error(&self, message: impl Into<String>) -> ReadError {
        ReadError::new(message).at(Place::Byte(self.at))
    }

    /// An error at this line and column.
    pub fn text_error(&self, message: impl Into<String>) -> ReadError {
        ReadError::new(message).at(Place::in_text(self.bytes, self.at))
    }

    /// An error at the word that was just read.
    pub fn text_error_before(&self, word: &[u8], message: impl Into<String>) -> ReadError {
        self.text_error_at(self.at.saturating_sub(word.len()), message)
    }

    /// An error at the line and column of a byte.
    pub fn text_error_at(&self, at: usize, message: impl Into<String>) -> ReadError {
        ReadError::new(message).at(Place::in_text(self.bytes, at))
    }
}

/// A count written as text.
pub(super) fn count_of(word: &[u8]) -> Option<usize> {
    std::str::from_utf8(word).ok()?.parse().ok()
}
