//! The files that spans point into.

use std::sync::Arc;

/// A file in a [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(pub u32);

/// A byte range in a file, end exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    pub file: FileId,
    pub start: u32,
    pub end: u32,
}

impl Span {
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        Self { file, start: start as u32, end: end as u32 }
    }

    /// The smallest span over both, which must lie in one file.
    pub fn to(self, other: Span) -> Self {
        debug_assert_eq!(self.file, other.file);
        Self { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// Line and column as people count them: from 1, columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    pub line: u32,
    pub column: u32,
}

#[derive(Clone, Debug)]
struct Source {
    path: String,
    text: Arc<str>,
    line_starts: Arc<[u32]>,
}

/// Every text that was read in a run, by id. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<Source>,
}

impl Sources {
    pub fn new() -> Self {
        Self::default()
    }

    /// Registers a text under the path that messages show. The same path with the same text
    /// keeps its id.
    pub fn add(&mut self, path: impl Into<String>, text: impl Into<Arc<str>>) -> FileId {
        let (path, text) = (path.into(), text.into());
        if let Some(at) = self.files.iter().position(|f| f.path == path && f.text == text) {
            return FileId(at as u32);
        }
        let line_starts = std::iter::once(0)
            .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i as u32 + 1))
            .collect();
        self.files.push(Source { path, text, line_starts });
        FileId(self.files.len() as u32 - 1)
    }

    pub fn path(&self, file: FileId) -> &str {
        &self.files[file.0 as usize].path
    }

    pub fn text(&self, file: FileId) -> &Arc<str> {
        &self.files[file.0 as usize].text
    }

    pub fn snippet(&self, span: Span) -> &str {
        &self.text(span.file)[span.start as usize..span.end as usize]
    }

    pub fn ids(&self) -> impl Iterator<Item = FileId> + use<> {
        (0..self.files.len() as u32).map(FileId)
    }

    /// Where a byte offset lies.
    pub fn position(&self, file: FileId, offset: u32) -> Position {
        let source = &self.files[file.0 as usize];
        let line = source.line_starts.partition_point(|start| *start <= offset).saturating_sub(1);
        let start = source.line_starts[line] as usize;
        let end = (offset as usize).min(source.text.len()).max(start);
        let column = source.text.get(start..end).map_or(end - start, |s| s.chars().count());
        Position { line: line as u32 + 1, column: column as u32 + 1 }
    }

    /// The byte range of a line (from 0), its end of line included.
    pub(super) fn line_bytes(&self, file: FileId, line: usize) -> Option<std::ops::Range<usize>> {
        let source = &self.files[file.0 as usize];
        let start = *source.line_starts.get(line)? as usize;
        let end = source.line_starts.get(line + 1).map_or(source.text.len(), |next| *next as usize);
        Some(start..end)
    }
}
