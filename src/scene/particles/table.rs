//! CSV: a header line with the columns' names, then a row for each particle. A text has no types,
//! so whole numbers are taken as the narrowest of `i32`, `u32`, `i64` and `u64` that holds the
//! column, and all others as `f64`.

use std::borrow::Cow;
use std::collections::HashMap;

use super::Attribute;
use super::cursor::Cursor;
use super::error::{Place, ReadError, counted, shown};
use super::finish::Found;
use super::group::{Group, group};
use super::values::{Number, Values};

/// More columns than any writer makes; a bound on the work that a header can cause.
const MOST_COLUMNS: usize = 1024;
/// Lines with other things than particles that may stand before the header.
const MOST_LINES_BEFORE: usize = 16;

struct Cell<'a> {
    /// Bytes from the start of the line.
    at: usize,
    text: Cow<'a, [u8]>,
}

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    let mut lines = Lines { bytes, cursor: Cursor::of_text(bytes) };
    let mut notes = Vec::new();
    let Header { names, separator, at } = lines.header(&mut notes)?;
    let mut columns: Vec<Column> = names.iter().map(|_| Column::Unseen).collect();
    // Where each column that is none of numbers has its first text.
    let mut texts = Vec::new();
    while let Some((start, line)) = lines.next() {
        let mut cells = split(line, separator);
        if cells.len() == names.len() + 1 {
            drop_empty_end(&mut cells);
        }
        if cells.len() != names.len() {
            let message = format!("expected {} as in the header, found {}", counted(names.len(), "cell"), cells.len());
            return Err(ReadError::new(message).at(Place::in_text(bytes, start)));
        }
        for ((cell, column), name) in cells.iter().zip(&mut columns).zip(&names) {
            if !column.is_text() && column.push(&cell.text).is_err() {
                texts.push((name.clone(), start + cell.at, shown(&cell.text)));
            }
        }
    }
    assemble(&names, columns, notes, Place::in_text(bytes, at), |name| {
        let (_, at, found) = texts.iter().find(|(known, ..)| known == name)?;
        Some(not_a_number(name, found, Place::in_text(bytes, *at)))
    })
}

fn is_position(group: &Group) -> bool {
    group.name == "position" && group.columns.len() == 3
}

fn not_a_number(name: &str, found: &str, place: Place) -> ReadError {
    ReadError::new(format!("column `{name}`: expected a number, found {found}")).at(place)
}

struct Lines<'a> {
    bytes: &'a [u8],
    cursor: Cursor<'a>,
}

impl<'a> Lines<'a> {
    /// The next line that is neither empty nor a comment, and where it begins.
    fn next(&mut self) -> Option<(usize, &'a [u8])> {
        loop {
            let start = self.cursor.offset();
            let line = self.cursor.line()?;
            let text = line.trim_ascii_start();
            if !text.is_empty() && !text.starts_with(b"#") {
                return Some((start, line));
            }
        }
    }

    /// The columns' names and what separates cells. Three columns need no header.
    fn header(&mut self, notes: &mut Vec<String>) -> Result<Header, ReadError> {
        let before = self.cursor.clone();
        let Some((at, line)) = self.next() else {
            let place = Place::in_text(self.bytes, self.bytes.len());
            return Err(ReadError::new("expected a header line, found the end of the file").at(place));
        };
        let first = self.header_of(at, line)?;
        if let Some(later) = self.later_header(&first)? {
            let Place::Line { line, .. } = Place::in_text(self.bytes, later.at) else { return Ok(later) };
            notes.push(format!("what stands before the header in line {line} is left out"));
            return Ok(later);
        }
        if !first.names.iter().all(|name| number(name.as_bytes()).is_some()) {
            return Ok(first);
        }
        if first.names.len() != 3 {
            let message = format!("expected a header line with names, found {}", counted(first.names.len(), "number"));
            let place = Place::in_text(self.bytes, at);
            return Err(ReadError::new(message).at(place).hint("a header line such as `x,y,z,density`"));
        }
        self.cursor = before;
        notes.push("there is no header line; the three columns are taken as x, y and z".to_owned());
        Ok(Header { names: ["x", "y", "z"].map(str::to_owned).to_vec(), ..first })
    }

    /// The header, where others than columns of particles stand before it; behind it the rows follow.
    fn later_header(&mut self, first: &Header) -> Result<Option<Header>, ReadError> {
        let mut ahead = Lines { bytes: self.bytes, cursor: self.cursor.clone() };
        let mut header = first.clone();
        for _ in 0..MOST_LINES_BEFORE {
            if header.has_position() {
                break;
            }
            let Some((at, line)) = ahead.next() else { return Ok(None) };
            header = self.header_of(at, line)?;
        }
        if !header.has_position() || header.at == first.at {
            return Ok(None);
        }
        self.cursor = ahead.cursor;
        Ok(Some(header))
    }

    fn header_of(&self, at: usize, line: &[u8]) -> Result<Header, ReadError> {
        let separator = separator(line);
        let mut cells = split(line, separator);
        drop_empty_end(&mut cells);
        if cells.len() > MOST_COLUMNS {
            let place = Place::in_text(self.bytes, at);
            return Err(ReadError::new(format!("more than {MOST_COLUMNS} columns")).at(place));
        }
        let name = |cell: &Cell<'_>| String::from_utf8_lossy(&cell.text).trim().to_owned();
        Ok(Header { names: without_units(cells.iter().map(name).collect()), separator, at })
    }
}

/// Names of columns, and what stands between cells.
#[derive(Clone)]
struct Header {
    names: Vec<String>,
    separator: u8,
    /// The byte at which the line begins.
    at: usize,
}

impl Header {
    fn has_position(&self) -> bool {
        group(&self.names).iter().any(is_position)
    }
}

/// Some writers end each line with a separator.
fn drop_empty_end(cells: &mut Vec<Cell<'_>>) {
    if cells.len() > 1 && cells.last().is_some_and(|cell| cell.text.is_empty()) {
        cells.pop();
    }
}

/// `Vel.x [m/s]` is `Vel.x`, unless another column is called so too. `P [x]` is a component.
fn without_units(names: Vec<String>) -> Vec<String> {
    const COMPONENTS: &[&str] = &["x", "y", "z", "w", "0", "1", "2", "3"];
    let bare = |name: &String| {
        let (bare, unit) = name.strip_suffix(']')?.rsplit_once(" [")?;
        let is_unit = !COMPONENTS.iter().any(|component| component.eq_ignore_ascii_case(unit.trim()));
        (is_unit && !bare.trim().is_empty()).then(|| bare.trim().to_owned())
    };
    let bared: Vec<String> = names.iter().map(|name| bare(name).unwrap_or_else(|| name.clone())).collect();
    let mut counts: HashMap<&str, usize> = HashMap::new();
    bared.iter().for_each(|name| *counts.entry(name).or_default() += 1);
    let is_one = |name: &String| counts.get(name.as_str()) == Some(&1);
    bared.iter().zip(&names).map(|(bare, name)| if is_one(bare) { bare } else { name }.clone()).collect()
}

/// The candidate that is most often in the header; spaces where it has no other.
fn separator(header: &[u8]) -> u8 {
    let often = |separator: u8| header.iter().filter(|&&b| b == separator).count();
    let most = [b'\t', b';', b','].into_iter().max_by_key(|&separator| often(separator)).unwrap_or(b',');
    if often(most) == 0 && header.trim_ascii().contains(&b' ') { b' ' } else { most }
}

/// The cells of a line. A cell in double quotes may hold separators, and quotes as `""`.
fn split(line: &[u8], separator: u8) -> Vec<Cell<'_>> {
    let mut cells = Vec::new();
    let mut at = 0;
    loop {
        let rest = &line[at..];
        let spaces = rest.iter().position(|b| *b != b' ').unwrap_or(0);
        if separator == b' ' && (spaces > 0 || rest.is_empty()) {
            // Several are one, and those at the ends none.
            at += spaces;
            if rest.trim_ascii().is_empty() {
                return cells;
            }
            continue;
        }
        let (length, text) = match rest.get(spaces) {
            Some(b'"') => quoted(&rest[spaces + 1..], separator, spaces + 1),
            _ => {
                let length = rest.iter().position(|&b| b == separator).unwrap_or(rest.len());
                (length, Cow::Borrowed(rest[..length].trim_ascii()))
            }
        };
        cells.push(Cell { at: at + spaces.min(length), text });
        at += length + 1;
        if at > line.len() {
            return cells;
        }
    }
}

/// A cell after its opening quote, and the length of all up to the separator; `before` is that of
/// what came before.
fn quoted(rest: &[u8], separator: u8, before: usize) -> (usize, Cow<'_, [u8]>) {
    let mut text = Vec::new();
    let mut at = 0;
    while let Some(&byte) = rest.get(at) {
        at += 1;
        if byte != b'"' {
            text.push(byte);
        } else if rest.get(at) == Some(&b'"') {
            text.push(byte);
            at += 1;
        } else {
            break;
        }
    }
    let after = &rest[at..];
    let to_separator = after.iter().position(|&b| b == separator).unwrap_or(after.len());
    (before + at + to_separator, Cow::Owned(text))
}

pub(super) enum Column {
    Unseen,
    Whole(Vec<i128>),
    Float(Vec<f64>),
    /// A cell was no number: the column is left out.
    Text,
}

enum Cipher {
    Whole(i128),
    Float(f64),
}

/// The number that a cell holds; an empty one is not a number, as the floats know it.
fn number(cell: &[u8]) -> Option<Cipher> {
    let word = std::str::from_utf8(cell.trim_ascii()).ok()?;
    if word.is_empty() {
        return Some(Cipher::Float(f64::NAN));
    }
    match word.parse::<i64>() {
        Ok(0) if word.starts_with('-') => Some(Cipher::Float(-0.0)),
        Ok(whole) => Some(Cipher::Whole(whole.into())),
        Err(_) => match word.parse::<u64>() {
            Ok(whole) => Some(Cipher::Whole(whole.into())),
            Err(_) => f64::from_text(word).map(Cipher::Float),
        },
    }
}

impl Column {
    pub fn is_text(&self) -> bool {
        matches!(self, Self::Text)
    }

    /// # Errors
    /// If the cell is no number; the column is one of texts from then on.
    pub fn push(&mut self, cell: &[u8]) -> Result<(), ()> {
        let found = number(cell);
        match (&mut *self, found) {
            (Self::Text, _) => {}
            (_, None) => {
                *self = Self::Text;
                return Err(());
            }
            (Self::Unseen, Some(Cipher::Whole(whole))) => *self = Self::Whole(vec![whole]),
            (Self::Unseen, Some(Cipher::Float(float))) => *self = Self::Float(vec![float]),
            (Self::Whole(all), Some(Cipher::Whole(whole))) => all.push(whole),
            (Self::Whole(all), Some(Cipher::Float(float))) => {
                let floats = all.iter().map(|&whole| whole as f64).chain([float]).collect();
                *self = Self::Float(floats);
            }
            (Self::Float(all), Some(Cipher::Whole(whole))) => all.push(whole as f64),
            (Self::Float(all), Some(Cipher::Float(float))) => all.push(float),
        }
        Ok(())
    }

    pub fn values(self) -> Option<Values> {
        match self {
            Self::Unseen => Some(Values::F64(Vec::new())),
            Self::Text => None,
            Self::Float(all) => Some(Values::F64(all)),
            Self::Whole(all) => {
                let narrow = narrowed(&all, Values::I32).or_else(|| narrowed(&all, Values::U32));
                let wide = narrow.or_else(|| narrowed(&all, Values::I64)).or_else(|| narrowed(&all, Values::U64));
                Some(wide.unwrap_or_else(|| Values::F64(all.iter().map(|&whole| whole as f64).collect())))
            }
        }
    }
}

fn narrowed<T: TryFrom<i128>>(all: &[i128], wrap: fn(Vec<T>) -> Values) -> Option<Values> {
    all.iter().map(|&whole| T::try_from(whole).ok()).collect::<Option<Vec<T>>>().map(wrap)
}

/// The columns as attributes; `header` is where their names stand, and `text` tells where a column that is none of numbers has a text.
fn assemble(
    names: &[String],
    columns: Vec<Column>,
    mut notes: Vec<String>,
    header: Place,
    text: impl Fn(&str) -> Option<ReadError>,
) -> Result<Found, ReadError> {
    // The position must be numbers: what is wrong with it is told where it is.
    let position = group(names).into_iter().find(is_position);
    let wrong = position.and_then(|g| g.columns.iter().find(|&&c| columns[c].is_text()).and_then(|&c| text(&names[c])));
    if let Some(wrong) = wrong {
        return Err(wrong);
    }
    let mut kept = Vec::new();
    let mut kept_names = Vec::new();
    for (name, column) in names.iter().zip(columns) {
        match column.values() {
            _ if name.is_empty() => {}
            Some(values) => {
                kept.push(Some(values));
                kept_names.push(name.clone());
            }
            None => notes.push(format!("column `{name}` is left out: it holds text")),
        }
    }
    let mut position = None;
    let mut attributes = Vec::new();
    for group in group(&kept_names) {
        let parts: Vec<Values> = group.columns.iter().filter_map(|&i| kept.get_mut(i)?.take()).collect();
        let components = parts.len();
        let values = Values::interleave(parts);
        if group.name == "position" && components == 3 && position.is_none() {
            position = Some(if values.kind().is_float() { values } else { Values::F64(values.to_f64()) });
        } else {
            attributes.push(Attribute { name: group.name, components, values });
        }
    }
    let Some(position) = position else {
        let found: Vec<String> = names.iter().take(12).map(|name| shown(name.as_bytes())).collect();
        let message = format!("no columns for the position: the header has {}", found.join(", "));
        let error = ReadError::new(message).at(header);
        return Err(error.hint("`x`, `y`, `z` or `position_x`, `position_y`, `position_z` are known"));
    };
    let mut found = Found::new(position);
    found.attributes = attributes;
    found.notes = notes;
    Ok(found)
}
