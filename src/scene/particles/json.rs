//! JSON: a list of rows (`[[x, y, z], ...]` or `[{"x": 1, "y": 2, "z": 3, "id": 7}, ...]`), or an object of
//! columns (`{"position": [[x, y, z], ...], "id": [7, ...]}`, a vector's numbers also one after the
//! other). As in a table, whole numbers take the narrowest type that holds a column, all others `f64`.
//!
//! The text is read in one pass without a tree of its values, so that memory is bounded by the numbers.

use std::collections::HashMap;

use super::Attribute;
use super::cursor::Cursor;
use super::error::{Place, ReadError, counted, shown};
use super::finish::Found;
use super::group::{group, means_position};
use super::table::Column;
use super::values::Values;

/// Lists and objects in one another.
const DEEPEST: usize = 16;
/// More columns than any writer makes; a bound on the work that names can cause.
const MOST_COLUMNS: usize = 1024;

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    let at = Cursor::of_text(bytes).offset();
    let mut reader = Reader { bytes, at, columns: Vec::new(), index: HashMap::new(), globals: Vec::new() };
    reader.value("position", Role::Outside, 0)?;
    if let Some(more) = reader.peek() {
        return Err(reader.error(format!("expected the end of the file, found {}", shown(&[more]))));
    }
    reader.assemble()
}

/// Where a value stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    /// In no list.
    Outside,
    /// A row of a list.
    Row,
    /// Inside a row.
    Cell,
}

struct Named {
    name: String,
    column: Column,
    /// Numbers so far.
    length: usize,
    /// Numbers of a row; absent until the first row ends.
    width: Option<usize>,
    /// Whether rows are lists of numbers or objects, and not bare numbers.
    has_rows: bool,
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    columns: Vec<Named>,
    index: HashMap<String, usize>,
    globals: Vec<(String, f64)>,
}

impl<'a> Reader<'a> {
    fn value(&mut self, name: &str, role: Role, depth: usize) -> Result<(), ReadError> {
        if depth > DEEPEST {
            return Err(self.error(format!("more than {DEEPEST} lists and objects in one another")));
        }
        match self.peek() {
            Some(b'[') if role == Role::Outside => self.list(name, depth),
            Some(b'[') => self.each(b']', |reader| reader.value(name, Role::Cell, depth + 1)),
            Some(b'{') => self.object(name, role, depth),
            Some(b'"') => {
                self.string()?;
                if role != Role::Outside {
                    let at = self.column(name)?;
                    self.columns[at].column = Column::Text;
                }
                Ok(())
            }
            _ => self.number(name, role),
        }
    }

    /// A list of rows.
    fn list(&mut self, name: &str, depth: usize) -> Result<(), ReadError> {
        let mut rows = 0_usize;
        let mut of_objects = false;
        let column = self.column(name)?;
        if self.columns[column].length > 0 {
            return Err(self.error(format!("{} comes twice", shown(name.as_bytes()))));
        }
        let mut first = None;
        self.each(b']', |reader| {
            let start = reader.peek();
            let at = reader.at;
            let (wanted, found) = (*first.get_or_insert(kind(start)), kind(start));
            if found != wanted {
                return Err(reader.error(format!("row {}: {found}, and {wanted} in the rows before", rows + 1)));
            }
            reader.value(name, Role::Row, depth + 1)?;
            rows += 1;
            match start {
                Some(b'{') => {
                    of_objects = true;
                    reader.row_ends(rows, name, true, at)
                }
                Some(b'[') => reader.row_ends(rows, name, false, at),
                _ => Ok(()),
            }
        })?;
        if of_objects {
            // The list's own name stood for nothing.
            let at = self.column(name)?;
            if self.columns[at].length == 0 && !self.columns[at].column.is_text() {
                self.columns[at].column = Column::Text;
                self.columns[at].name.clear();
                self.index.remove(name);
            }
        }
        Ok(())
    }

    /// After a row of the list `list`, all columns if it has objects, else the one of its name, have
    /// as many numbers as in the rows before.
    fn row_ends(&mut self, rows: usize, list: &str, of_objects: bool, at: usize) -> Result<(), ReadError> {
        for Named { name, column, length, width, has_rows } in &mut self.columns {
            let is_own = name == list;
            if column.is_text() || is_own == of_objects && (!is_own || *length == 0) {
                continue;
            }
            *has_rows = true;
            let wanted = *width.get_or_insert(*length);
            if *length != wanted.saturating_mul(rows) {
                let found = length.saturating_sub(wanted * (rows - 1));
                let message =
                    format!("row {rows}: `{name}` has {}, and {wanted} in the rows before", counted(found, "number"));
                return Err(ReadError::new(message).at(Place::in_text(self.bytes, at)));
            }
        }
        Ok(())
    }

    /// An object in a list is a row; in a row its names go on; else its values are columns.
    fn object(&mut self, name: &str, role: Role, depth: usize) -> Result<(), ReadError> {
        self.each(b'}', |reader| {
            if reader.peek() != Some(b'"') {
                return Err(reader.error("expected a name in quotes"));
            }
            let key = reader.string()?;
            if reader.peek() != Some(b':') {
                return Err(reader.error(format!("expected `:` behind {}", shown(key.as_bytes()))));
            }
            reader.at += 1;
            match role {
                Role::Outside => reader.value(&key, Role::Outside, depth + 1),
                Role::Row => reader.value(&key, Role::Cell, depth + 1),
                Role::Cell => reader.value(&format!("{name}.{key}"), Role::Cell, depth + 1),
            }
        })
    }

    /// What stands between brackets, with commas between.
    fn each(&mut self, end: u8, mut item: impl FnMut(&mut Self) -> Result<(), ReadError>) -> Result<(), ReadError> {
        self.at += 1;
        if self.peek() == Some(end) {
            self.at += 1;
            return Ok(());
        }
        loop {
            item(self)?;
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(found) if found == end => {
                    self.at += 1;
                    return Ok(());
                }
                Some(_) => {
                    let message = format!("expected `,` or `{}`, found {}", char::from(end), shown(self.word()));
                    return Err(self.error(message));
                }
                None => return Err(self.error(format!("expected `{}`, found the end of the file", char::from(end)))),
            }
        }
    }

    fn number(&mut self, name: &str, role: Role) -> Result<(), ReadError> {
        let word = self.word();
        let digits: &[u8] = match word {
            b"true" => b"1",
            b"false" => b"0",
            b"null" => b"nan",
            _ => word,
        };
        let mut one = Column::Unseen;
        if word.is_empty() || one.push(digits).is_err() {
            let found = if word.is_empty() { self.rest_shown() } else { shown(word) };
            return Err(self.error(format!("expected a number, found {found}")));
        }
        if role == Role::Outside {
            self.globals.extend(one.values().and_then(|v| v.uniform()).map(|value| (name.to_owned(), value)));
        } else {
            let at = self.column(name)?;
            // A word that is a number for one is one for all.
            _ = self.columns[at].column.push(digits);
            self.columns[at].length += 1;
        }
        self.at += word.len();
        Ok(())
    }

    fn rest_shown(&self) -> String {
        match self.bytes.get(self.at) {
            Some(byte) => shown(&[*byte]),
            None => "the end of the file".to_owned(),
        }
    }

    fn column(&mut self, name: &str) -> Result<usize, ReadError> {
        if let Some(at) = self.index.get(name) {
            return Ok(*at);
        }
        if self.columns.len() >= MOST_COLUMNS {
            return Err(self.error(format!("more than {MOST_COLUMNS} columns")));
        }
        let at = self.columns.len();
        self.index.insert(name.to_owned(), at);
        let (column, length) = (Column::Unseen, 0);
        self.columns.push(Named { name: name.to_owned(), column, length, width: None, has_rows: false });
        Ok(at)
    }

    /// A text in quotes; what is escaped is kept as it is written but for quotes.
    fn string(&mut self) -> Result<String, ReadError> {
        let rest = self.bytes.get(self.at + 1..).unwrap_or_default();
        let mut end = 0;
        loop {
            match rest.get(end) {
                Some(b'"') => break,
                Some(b'\\') => end += 2,
                Some(_) => end += 1,
                None => return Err(self.error("a text without its closing quote")),
            }
        }
        let text = String::from_utf8_lossy(&rest[..end]).replace("\\\"", "\"");
        self.at += end + 2;
        Ok(text)
    }

    /// The next byte that is no white space.
    fn peek(&mut self) -> Option<u8> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        self.at += rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        self.bytes.get(self.at).copied()
    }

    fn word(&mut self) -> &'a [u8] {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let ends = |b: &u8| !(b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.' | b'_'));
        &rest[..rest.iter().position(ends).unwrap_or(rest.len())]
    }

    fn error(&self, message: impl Into<String>) -> ReadError {
        ReadError::new(message).at(Place::in_text(self.bytes, self.at))
    }

    fn assemble(self) -> Result<Found, ReadError> {
        let mut notes = Vec::new();
        let mut wide = Vec::new();
        let (mut names, mut single) = (Vec::new(), Vec::new());
        for Named { name, column, width, has_rows, .. } in self.columns {
            match column.values() {
                _ if name.is_empty() => {}
                None => notes.push(format!("`{name}` is left out: it holds text")),
                Some(values) if has_rows && width.is_some_and(|width| width > 1) => {
                    wide.push((name, width.unwrap_or(1), values));
                }
                Some(values) => {
                    names.push(name);
                    single.push(Some(values));
                }
            }
        }
        for group in group(&names) {
            let parts: Vec<Values> = group.columns.iter().filter_map(|&i| single.get_mut(i)?.take()).collect();
            wide.push((group.name, parts.len(), Values::interleave(parts)));
        }
        let Some(position) = take_position(&mut wide) else {
            let found: Vec<String> = wide.iter().take(12).map(|(name, ..)| shown(name.as_bytes())).collect();
            let message =
                format!("no position: there is {}", if found.is_empty() { "nothing".into() } else { found.join(", ") });
            let hint = "rows are `[x, y, z]` or objects with `x`, `y`, `z` or `position`";
            return Err(ReadError::new(message).at(Place::Line { line: 1, column: 1 }).hint(hint));
        };
        let rows = position.len() / 3;
        let mut found = Found::new(position);
        found.attributes = wide.into_iter().map(|(name, width, values)| of_rows(name, width, values, rows)).collect();
        (found.globals, found.notes) = (self.globals, notes);
        Ok(found)
    }
}

/// What begins so.
fn kind(start: Option<u8>) -> &'static str {
    match start {
        Some(b'{') => "an object",
        Some(b'[') => "a list",
        _ => "a single value",
    }
}

/// The column that is the position: triples, or one whose numbers follow one another.
fn take_position(columns: &mut Vec<(String, usize, Values)>) -> Option<Values> {
    let fits = |(name, width, values): &(String, usize, Values)| {
        means_position(name) && (*width == 3 || (*width == 1 && values.len().is_multiple_of(3)))
    };
    let at = columns.iter().position(|c| fits(c) && c.0 == "position").or_else(|| columns.iter().position(fits))?;
    let (_, _, values) = columns.remove(at);
    Some(if values.kind().is_float() { values } else { Values::F64(values.to_f64()) })
}

/// A column whose numbers follow one another has as many in a row as fit.
fn of_rows(name: String, width: usize, values: Values, rows: usize) -> Attribute {
    let follows = width == 1 && rows > 0 && values.len() > rows && values.len().is_multiple_of(rows);
    Attribute { name, components: if follows { values.len() / rows } else { width }, values }
}
