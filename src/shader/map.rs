//! From places in the text that naga was given to places in the files that the person wrote.

use std::path::PathBuf;

use crate::diagnostic::{Diagnostic, FileId, Span};

/// The files that a module's text is made of, and which stretch of it comes from where.
#[derive(Clone, Debug)]
pub struct SourceMap {
    pub(super) units: Vec<Unit>,
    /// Sorted by `whole`.
    pub(super) segments: Vec<Segment>,
    /// Index of the named file in `units`.
    pub(super) named: usize,
}

/// A file of a module.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    pub path: PathBuf,
    pub file: FileId,
    /// In bytes.
    pub length: u32,
    /// The unit that imported it first, and the path in that import.
    pub via: Option<(usize, Span)>,
    /// Indices of the units that it imports.
    pub imports: Vec<usize>,
}

/// `length` bytes from `whole` on come from `offset` on of a unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub whole: u32,
    pub length: u32,
    pub unit: usize,
    pub offset: u32,
}

impl SourceMap {
    /// The place in a file, or nothing for a span that naga left undefined. A span that runs
    /// over the end of a file is cut there.
    pub fn span(&self, whole: naga::Span) -> Option<Span> {
        let range = whole.to_range()?;
        let (unit, from, end) = self.locate(range.start as u32)?;
        let length = (range.end - range.start) as u32;
        let span = Span { file: self.units[unit].file, start: from, end: end.min(from + length) };
        Some(span)
    }

    /// The unit of a byte of the whole, the offset in its file, and where its stretch ends there.
    fn locate(&self, at: u32) -> Option<(usize, u32, u32)> {
        let index = self.segments.partition_point(|s| s.whole <= at).checked_sub(1)?;
        let segment = self.segments[index];
        let within = (at - segment.whole).min(segment.length);
        Some((segment.unit, segment.offset + within, segment.offset + segment.length))
    }

    /// The place to point at where nothing better is known.
    pub(super) fn start(&self) -> Span {
        Span { file: self.named().file, start: 0, end: 0 }
    }

    pub(super) fn named(&self) -> &Unit {
        &self.units[self.named]
    }

    /// Every file of the module, the named one first.
    pub(super) fn paths(&self) -> impl Iterator<Item = PathBuf> {
        self.units.iter().map(|u| u.path.clone())
    }

    /// The file of each unit.
    pub(super) fn files(&self) -> impl Iterator<Item = FileId> {
        self.units.iter().map(|u| u.file)
    }

    pub(super) fn file(&self, unit: usize) -> FileId {
        self.units[unit].file
    }

    /// The unit whose text stands before that of the span's file, and the span's unit.
    pub(super) fn file_before(&self, span: Span) -> Option<(usize, usize)> {
        let is_whole = |s: &&Segment| s.length == self.units[s.unit].length;
        let bodies: Vec<usize> = self.segments.iter().filter(is_whole).map(|s| s.unit).collect();
        let at = bodies.iter().position(|unit| self.units[*unit].file == span.file)?;
        Some((bodies[at.checked_sub(1)?], bodies[at]))
    }

    fn unit(&self, file: FileId) -> Option<&Unit> {
        self.units.iter().find(|u| u.file == file)
    }

    /// Adds the imports through which the first label's file came into the module, from the
    /// nearest to the one in the named file.
    pub(super) fn imported(&self, mut diagnostic: Diagnostic) -> Diagnostic {
        let mut via = diagnostic.labels.first().and_then(|l| self.unit(l.span.file)).and_then(|u| u.via);
        while let Some((importer, span)) = via {
            diagnostic = diagnostic.see(span, "imported here");
            via = self.units[importer].via;
        }
        diagnostic
    }
}
