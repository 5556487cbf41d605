//! The arrays of point data, of cell data (read over) and of the whole dataset.

use super::{Attribute, ReadError, Reader, Section, Type, count_of, shown};
use crate::scene::particles::values::{Kind, Values};

impl Reader<'_> {
    /// An array of a section, by the keyword that begins it.
    pub(super) fn array_keyword(&mut self, word: &[u8]) -> Result<(), ReadError> {
        let keyword = word.to_ascii_uppercase();
        if keyword == b"FIELD" {
            return self.field();
        }
        let components = match keyword.as_slice() {
            b"SCALARS" => return self.scalars(),
            b"LOOKUP_TABLE" => return self.lookup_table(),
            b"COLOR_SCALARS" => return self.color_scalars(),
            b"TEXTURE_COORDINATES" => None,
            b"GLOBAL_IDS" | b"PEDIGREE_IDS" | b"EDGE_FLAGS" => Some(1),
            b"VECTORS" | b"NORMALS" => Some(3),
            b"TENSORS6" => Some(6),
            b"TENSORS" => Some(9),
            _ => {
                let error = self.error_before(word, format!("expected a keyword, found {}", shown(word)));
                return Err(error.hint("the data before it may be shorter or longer than its header says"));
            }
        };
        let name = self.name()?;
        let components = match components {
            Some(components) => components,
            None => self.count("the number of texture coordinates")?,
        };
        let kind = self.number_type()?;
        self.end_header();
        self.array(name, components, self.rows, kind)
    }

    fn scalars(&mut self) -> Result<(), ReadError> {
        let name = self.name()?;
        let kind = self.number_type()?;
        let components = match self.cursor.word_on_line() {
            Some(word) => count_of(word).ok_or_else(|| {
                self.error_before(word, format!("expected the number of components, found {}", shown(word)))
            })?,
            None => 1,
        };
        self.end_header();
        if self.cursor.sees("LOOKUP_TABLE") {
            self.cursor.finish_line();
        }
        self.array(name, components, self.rows, kind)
    }

    /// Colours of a palette: four numbers each, read over.
    fn lookup_table(&mut self) -> Result<(), ReadError> {
        self.name()?;
        let count = self.count("the size of the lookup table")?;
        self.skip(count.saturating_mul(4), 1, "lookup table")
    }

    /// Bytes in a binary file, fractions of one in a text.
    fn color_scalars(&mut self) -> Result<(), ReadError> {
        let name = self.name()?;
        let components = self.count("the number of components")?;
        self.end_header();
        let kind = if self.binary { Kind::U8 } else { Kind::F32 };
        self.array(name, components, self.rows, Type::Numbers(kind))
    }

    fn field(&mut self) -> Result<(), ReadError> {
        self.name()?;
        let arrays = self.count("the number of arrays")?;
        for _ in 0..arrays {
            self.skip_metadata();
            let name = self.name()?;
            let components = self.count("the number of components")?;
            let rows = self.count("the number of rows")?;
            let kind = self.number_type()?;
            self.end_header();
            self.array(name, components, rows, kind)?;
        }
        Ok(())
    }

    /// The numbers of one array, kept if they are one row for each point.
    fn array(&mut self, name: String, components: usize, rows: usize, kind: Type) -> Result<(), ReadError> {
        let what = format!("array `{name}`");
        let values = match kind {
            Type::Numbers(kind) => self.numbers_here(kind, rows, components, &what)?,
            Type::Bits => self.bits(rows, components, &what)?,
            Type::Text => {
                self.skip_strings(rows.saturating_mul(components), &what)?;
                if self.section == Section::Points {
                    self.notes.push(format!("attribute `{name}` is left out: it holds text"));
                }
                return Ok(());
            }
        };
        match self.section {
            Section::Points => self.attributes.push(Attribute { name, components, values }),
            Section::Dataset if values.len() == 1 => {
                self.globals.extend(values.uniform().map(|value| (name, value)));
            }
            Section::Dataset | Section::Cells => {}
        }
        Ok(())
    }

    fn bits(&mut self, rows: usize, components: usize, what: &str) -> Result<Values, ReadError> {
        if !self.binary {
            return self.numbers_here(Kind::U8, rows, components, what);
        }
        let count = rows.saturating_mul(components);
        let bytes = self.cursor.take(count.div_ceil(8), what)?;
        Ok(Values::from_bits(bytes, count))
    }

    /// Text holds a string a line; binary has its length before each, in the number of bytes that
    /// the two highest bits of the first tell.
    fn skip_strings(&mut self, count: usize, what: &str) -> Result<(), ReadError> {
        for _ in 0..count {
            if !self.binary {
                if self.cursor.line().is_none() {
                    return Err(self.error(format!("{what}: expected a line of text, found the end of the file")));
                }
                continue;
            }
            let first = self.cursor.take(1, what)?[0];
            let more = self.cursor.take([7, 3, 1, 0][usize::from(first >> 6)], what)?;
            let length = more.iter().fold(u64::from(first & 0x3f), |sum, &byte| sum << 8 | u64::from(byte));
            self.cursor.take(usize::try_from(length).unwrap_or(usize::MAX), what)?;
        }
        Ok(())
    }

    /// A name; what cannot stand in one is written as `%20` and so on.
    fn name(&mut self) -> Result<String, ReadError> {
        let word = self.expect_word("a name")?;
        let mut name = Vec::with_capacity(word.len());
        let mut rest = word;
        while let Some((&first, after)) = rest.split_first() {
            let code = after.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
            match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
                Some(byte) if first == b'%' => {
                    name.push(byte);
                    rest = &after[2..];
                }
                _ => {
                    name.push(first);
                    rest = after;
                }
            }
        }
        Ok(String::from_utf8_lossy(&name).into_owned())
    }
}
