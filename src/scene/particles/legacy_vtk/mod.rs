//! Legacy VTK, versions 1 to 5, as text and as big-endian binary: the points of unstructured
//! grids and polygonal data, with their point data. Cells are read over, in the form of
//! version 4 (counts and indices in one list) and of version 5 (offsets and connectivity).

mod arrays;
mod cells;

use super::Attribute;
use super::cursor::{Cursor, count_of};
use super::error::{Place, ReadError, shown};
use super::finish::Found;
use super::polygons::Polygons;
use super::values::{Kind, Layout, Order, Values};
use cells::Cells;

/// Numbers as a file declares them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Type {
    Numbers(Kind),
    /// Eight to a byte in binary files.
    Bits,
    /// Strings, which are read over.
    Text,
}

/// What the data that follow belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Section {
    Dataset,
    Points,
    Cells,
}

struct Reader<'a> {
    cursor: Cursor<'a>,
    binary: bool,
    section: Section,
    /// Rows of the section.
    rows: usize,
    points: Option<Values>,
    attributes: Vec<Attribute>,
    globals: Vec<(String, f64)>,
    notes: Vec<String>,
    /// Where surfaces are asked for.
    cells: Option<Cells>,
}

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    read_all(open(bytes)?).map(|(found, _)| found)
}

/// The points and the polygons between them.
pub(super) fn read_surface(bytes: &[u8]) -> Result<(Found, Polygons), ReadError> {
    let (found, cells) = read_all(Reader { cells: Some(Cells::default()), ..open(bytes)? })?;
    let polygons = cells.unwrap_or_default().polygons(found.position.len() / 3)?;
    Ok((found, polygons))
}

fn read_all(mut reader: Reader<'_>) -> Result<(Found, Option<Cells>), ReadError> {
    while let Some(word) = reader.cursor.word() {
        reader.keyword(word)?;
    }
    let Some(points) = reader.points else {
        return Err(reader.cursor.text_error("expected POINTS, found the end of the file"));
    };
    let mut found = Found::new(points);
    found.attributes = reader.attributes;
    found.globals = reader.globals;
    found.notes = reader.notes;
    Ok((found, reader.cells))
}

/// Reads the four lines that every file begins with.
fn open(bytes: &[u8]) -> Result<Reader<'_>, ReadError> {
    let mut cursor = Cursor::of_text(bytes);
    let first = cursor.finish_line();
    let version = first.strip_prefix(b"# vtk DataFile Version ").and_then(|v| std::str::from_utf8(v).ok());
    let Some(version) = version.map(str::trim) else {
        let error = ReadError::new(format!("expected `# vtk DataFile Version`, found {}", shown(first)))
            .at(Place::Line { line: 1, column: 1 });
        let xml = first.trim_ascii_start().starts_with(b"<");
        return Err(if xml { error.hint("an XML file's extension is .vtu or .vtp") } else { error });
    };
    let major = version.split('.').next().and_then(|major| major.parse::<u32>().ok());
    if !major.is_some_and(|major| (1..=5).contains(&major)) {
        let message = format!("versions 1 to 5 are known, found {}", shown(version.as_bytes()));
        return Err(ReadError::new(message).at(Place::Line { line: 1, column: 24 }));
    }
    cursor.finish_line();
    let format = cursor.word().unwrap_or_default();
    let binary = match format.to_ascii_uppercase().as_slice() {
        b"ASCII" => false,
        b"BINARY" => true,
        _ => {
            let message = format!("expected ASCII or BINARY, found {}", shown(format));
            return Err(cursor.text_error_before(format, message));
        }
    };
    Ok(Reader {
        cursor,
        binary,
        section: Section::Dataset,
        rows: 0,
        points: None,
        attributes: Vec::new(),
        globals: Vec::new(),
        notes: Vec::new(),
        cells: None,
    })
}

impl<'a> Reader<'a> {
    fn keyword(&mut self, word: &[u8]) -> Result<(), ReadError> {
        match word.to_ascii_uppercase().as_slice() {
            b"DATASET" => self.dataset(),
            b"POINTS" => self.points(),
            b"CELLS" | b"VERTICES" | b"LINES" | b"POLYGONS" | b"TRIANGLE_STRIPS" if self.cells.is_some() => {
                self.keep_cells(word)
            }
            b"CELL_TYPES" if self.cells.is_some() => self.keep_cell_types(),
            b"CELLS" | b"VERTICES" | b"LINES" | b"POLYGONS" | b"TRIANGLE_STRIPS" => self.cells(),
            b"CELL_TYPES" => {
                let count = self.count("the number of cell types")?;
                self.skip(count, 4, "cell types")
            }
            b"POINT_DATA" => self.data(Section::Points),
            b"CELL_DATA" => self.data(Section::Cells),
            b"METADATA" => {
                self.metadata();
                Ok(())
            }
            _ => self.array_keyword(word),
        }
    }

    fn dataset(&mut self) -> Result<(), ReadError> {
        let kind = self.expect_word("the kind of dataset")?;
        match kind.to_ascii_uppercase().as_slice() {
            b"UNSTRUCTURED_GRID" | b"POLYDATA" => Ok(()),
            _ => {
                let message = format!("expected the dataset UNSTRUCTURED_GRID or POLYDATA, found {}", shown(kind));
                Err(self.error_before(kind, message))
            }
        }
    }

    fn points(&mut self) -> Result<(), ReadError> {
        if self.points.is_some() {
            return Err(self.error("a second POINTS in one file"));
        }
        let rows = self.count("the number of points")?;
        let Type::Numbers(kind) = self.number_type()? else {
            return Err(self.error("points must be numbers"));
        };
        self.points = Some(self.numbers(kind, rows, 3, "points")?);
        Ok(())
    }

    fn cells(&mut self) -> Result<(), ReadError> {
        let first = self.count("the number of cells")?;
        let second = self.count("the length of the list of cells")?;
        self.end_header();
        if !self.cursor.sees("OFFSETS") {
            return self.skip_here(second, 4, "cells");
        }
        for (keyword, count) in [("OFFSETS", first), ("CONNECTIVITY", second)] {
            let found = self.expect_word(keyword)?;
            if !found.eq_ignore_ascii_case(keyword.as_bytes()) {
                return Err(self.error_before(found, format!("expected {keyword}, found {}", shown(found))));
            }
            let Type::Numbers(kind) = self.number_type()? else {
                return Err(self.error("indices must be numbers"));
            };
            self.skip(count, kind.size(), "cells")?;
            self.skip_metadata();
        }
        Ok(())
    }

    fn data(&mut self, section: Section) -> Result<(), ReadError> {
        self.rows = self.count("the number of rows")?;
        self.section = section;
        let points = self.points.as_ref().map(|p| p.len() / 3);
        match points {
            Some(points) if section == Section::Points && points != self.rows => {
                Err(self.error(format!("POINT_DATA has {} rows, but there are {points} points", self.rows)))
            }
            _ => Ok(()),
        }
    }

    /// Reads over a block of metadata, which ends with an empty line.
    fn metadata(&mut self) {
        self.cursor.finish_line();
        while let Some(line) = self.cursor.line() {
            if line.trim_ascii().is_empty() {
                return;
            }
        }
    }

    /// Reads over a block of metadata if there is one.
    fn skip_metadata(&mut self) {
        let mut ahead = self.cursor.clone();
        if ahead.word().is_some_and(|word| word.eq_ignore_ascii_case(b"METADATA")) {
            self.cursor = ahead;
            self.metadata();
        }
    }

    fn expect_word(&mut self, what: &str) -> Result<&'a [u8], ReadError> {
        self.cursor.word().ok_or_else(|| self.error(format!("expected {what}, found the end of the file")))
    }

    fn count(&mut self, what: &str) -> Result<usize, ReadError> {
        let word = self.expect_word(what)?;
        count_of(word).ok_or_else(|| self.error_before(word, format!("expected {what}, found {}", shown(word))))
    }

    fn number_type(&mut self) -> Result<Type, ReadError> {
        let word = self.expect_word("a type")?;
        let kind = match word.to_ascii_lowercase().as_slice() {
            b"bit" => return Ok(Type::Bits),
            b"string" | b"utf8_string" => return Ok(Type::Text),
            b"float" | b"vtktypefloat32" => Kind::F32,
            b"double" | b"vtktypefloat64" => Kind::F64,
            b"char" | b"signed_char" | b"vtktypeint8" => Kind::I8,
            b"unsigned_char" | b"vtktypeuint8" => Kind::U8,
            b"short" | b"vtktypeint16" => Kind::I16,
            b"unsigned_short" | b"vtktypeuint16" => Kind::U16,
            // Writers store ids as `int`, whatever their width in memory was.
            b"int" | b"vtkidtype" | b"vtktypeint32" => Kind::I32,
            b"unsigned_int" | b"vtktypeuint32" => Kind::U32,
            b"long" | b"vtktypeint64" => Kind::I64,
            b"unsigned_long" | b"vtktypeuint64" => Kind::U64,
            _ => return Err(self.error_before(word, format!("expected a type such as float, found {}", shown(word)))),
        };
        Ok(Type::Numbers(kind))
    }

    /// Binary data begin right after the line that declares them.
    fn end_header(&mut self) {
        if self.binary {
            self.cursor.finish_line();
        } else {
            self.cursor.skip_space();
        }
    }

    /// The numbers that follow a header's line.
    fn numbers(&mut self, kind: Kind, rows: usize, components: usize, what: &str) -> Result<Values, ReadError> {
        self.end_header();
        self.numbers_here(kind, rows, components, what)
    }

    fn numbers_here(&mut self, kind: Kind, rows: usize, components: usize, what: &str) -> Result<Values, ReadError> {
        let size = kind.bytes(rows, components).map_err(|e| self.cursor.byte_error(e.message))?;
        if !self.binary {
            return self.cursor.numbers(kind, rows * components, what);
        }
        let bytes = self.cursor.take(size, what)?;
        let layout = Layout { start: 0, stride: kind.size() * components, components };
        Ok(Values::gather(kind, bytes, layout, rows, Order::Big))
    }

    fn skip(&mut self, count: usize, size: usize, what: &str) -> Result<(), ReadError> {
        self.end_header();
        self.skip_here(count, size, what)
    }

    fn skip_here(&mut self, count: usize, size: usize, what: &str) -> Result<(), ReadError> {
        if !self.binary {
            return self.cursor.skip_words(count, what);
        }
        self.cursor.take(count.saturating_mul(size), what).map(|_| ())
    }

    fn error(&self, message: impl Into<String>) -> ReadError {
        self.error_before(b"", message)
    }

    /// An error at the word that was just read: a line of a text, a byte of a binary file.
    fn error_before(&self, word: &[u8], message: impl Into<String>) -> ReadError {
        if self.binary {
            return ReadError::new(message).at(Place::Byte(self.cursor.offset().saturating_sub(word.len())));
        }
        self.cursor.text_error_before(word, message)
    }
}
