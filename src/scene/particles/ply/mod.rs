//! PLY: the element `vertex`, as text and as binary of either order. Properties that belong
//! together become one attribute; other elements are read over.

mod body;
mod faces;

use super::Attribute;
use super::cursor::{Cursor, count_of};
use super::error::{ReadError, shown};
use super::finish::Found;
use super::group::group;
use super::values::{Kind, Order, Values};
pub(super) use faces::read_surface;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Text,
    Binary(Order),
}

#[derive(Clone, Debug)]
enum Property {
    Scalar(String, Kind),
    /// The name, the kind of the length and the kind of the items.
    List(String, Kind, Kind),
}

impl Property {
    fn name(&self) -> &str {
        match self {
            Self::Scalar(name, _) | Self::List(name, ..) => name,
        }
    }
}

#[derive(Clone, Debug)]
struct Element {
    name: String,
    rows: usize,
    properties: Vec<Property>,
    /// The byte of the header at which its name begins.
    at: usize,
}

/// More properties than any writer makes; a bound on the work that a header can cause.
const MOST_PROPERTIES: usize = 1024;

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    let mut cursor = Cursor::of_text(bytes);
    let (format, elements) = header(&mut cursor)?;
    let Some(vertex) = elements.iter().position(|e| e.name == "vertex") else {
        return Err(cursor.text_error("the header has no element `vertex`"));
    };
    for element in &elements[..vertex] {
        body::skip(&mut cursor, element, format)?;
    }
    let columns = body::columns(&mut cursor, &elements[vertex], format)?;
    assemble(&cursor, &elements[vertex], columns)
}

/// The scalar properties as attributes.
fn assemble(cursor: &Cursor<'_>, vertex: &Element, columns: Vec<Values>) -> Result<Found, ReadError> {
    let mut notes = Vec::new();
    let mut names = Vec::new();
    for property in &vertex.properties {
        match property {
            Property::Scalar(name, _) => names.push(name.clone()),
            Property::List(name, ..) => notes.push(format!("property `{name}` is left out: it is a list")),
        }
    }
    let mut columns: Vec<Option<Values>> = columns.into_iter().map(Some).collect();
    let mut position = None;
    let mut attributes = Vec::new();
    for group in group(&names) {
        let parts: Vec<Values> = group.columns.iter().filter_map(|&i| columns.get_mut(i)?.take()).collect();
        let components = parts.len();
        let values = Values::interleave(parts);
        if group.name == "position" && components == 3 && position.is_none() {
            position = Some(values);
        } else {
            attributes.push(Attribute { name: group.name, components, values });
        }
    }
    let Some(position) = position else {
        return Err(cursor.text_error_at(vertex.at, "element `vertex` has no properties `x`, `y` and `z`"));
    };
    let mut found = Found::new(position);
    found.attributes = attributes;
    found.notes = notes;
    Ok(found)
}

fn header(cursor: &mut Cursor<'_>) -> Result<(Format, Vec<Element>), ReadError> {
    let first = cursor.finish_line();
    if first.trim_ascii() != b"ply" {
        let start = &first[..first.len().min(8)];
        return Err(Cursor::new(first).text_error(format!("expected `ply`, found {}", shown(start))));
    }
    let mut format = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let mut line = cursor.clone();
        if cursor.line().is_none() {
            return Err(cursor.text_error("expected `end_header`, found the end of the file"));
        }
        let keyword = line.word_on_line().unwrap_or_default();
        match keyword {
            b"format" => format = Some(format_of(&mut line)?),
            b"element" => elements.push(element(&mut line)?),
            b"property" => {
                let property = property(&mut line)?;
                match elements.last_mut() {
                    Some(element) if element.properties.len() < MOST_PROPERTIES => element.properties.push(property),
                    Some(_) => return Err(line.text_error(format!("more than {MOST_PROPERTIES} properties"))),
                    None => return Err(line.text_error("a property before any element")),
                }
            }
            b"end_header" => break,
            b"comment" | b"obj_info" | b"" => {}
            _ => {
                return Err(line.text_error_before(keyword, format!("expected `end_header`, found {}", shown(keyword))));
            }
        }
    }
    let format = format.ok_or_else(|| cursor.text_error("the header has no line `format`"))?;
    Ok((format, elements))
}

fn format_of(line: &mut Cursor<'_>) -> Result<Format, ReadError> {
    let word = line.word_on_line().unwrap_or_default();
    match word {
        b"ascii" => Ok(Format::Text),
        b"binary_little_endian" => Ok(Format::Binary(Order::Little)),
        b"binary_big_endian" => Ok(Format::Binary(Order::Big)),
        _ => {
            let known = "`ascii`, `binary_little_endian` or `binary_big_endian`";
            Err(line.text_error_before(word, format!("expected the format {known}, found {}", shown(word))))
        }
    }
}

fn element(line: &mut Cursor<'_>) -> Result<Element, ReadError> {
    let name = text(line, "an element's name")?;
    let at = line.offset().saturating_sub(name.len());
    let word = line.word_on_line().unwrap_or_default();
    let message = || format!("expected how many `{name}` there are, found {}", shown(word));
    let rows = count_of(word).ok_or_else(|| line.text_error_before(word, message()))?;
    Ok(Element { name, rows, properties: Vec::new(), at })
}

fn property(line: &mut Cursor<'_>) -> Result<Property, ReadError> {
    let mut ahead = line.clone();
    if ahead.word_on_line() != Some(b"list") {
        let kind = kind(line)?;
        return Ok(Property::Scalar(text(line, "a property's name")?, kind));
    }
    *line = ahead;
    let (length, items) = (kind(line)?, kind(line)?);
    if length.is_float() {
        return Err(line.text_error("the length of a list must be a whole number"));
    }
    Ok(Property::List(text(line, "a property's name")?, length, items))
}

fn text(line: &mut Cursor<'_>, what: &str) -> Result<String, ReadError> {
    match line.word_on_line() {
        Some(word) => Ok(String::from_utf8_lossy(word).into_owned()),
        None => Err(line.text_error(format!("expected {what}, found the end of the line"))),
    }
}

fn kind(line: &mut Cursor<'_>) -> Result<Kind, ReadError> {
    let word = line.word_on_line().unwrap_or_default();
    Ok(match word {
        b"char" | b"int8" => Kind::I8,
        b"uchar" | b"uint8" => Kind::U8,
        b"short" | b"int16" => Kind::I16,
        b"ushort" | b"uint16" => Kind::U16,
        b"int" | b"int32" => Kind::I32,
        b"uint" | b"uint32" => Kind::U32,
        b"int64" | b"long" => Kind::I64,
        b"uint64" | b"ulong" => Kind::U64,
        b"float" | b"float32" => Kind::F32,
        b"double" | b"float64" => Kind::F64,
        _ => {
            let message = format!("expected a type such as `float`, found {}", shown(word));
            return Err(line.text_error_before(word, message));
        }
    })
}
