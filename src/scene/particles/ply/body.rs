//! What follows a PLY header.

use super::{Element, Format, Kind, Order, Property, Values};
use crate::scene::particles::cursor::{Cursor, count_of};
use crate::scene::particles::error::{ReadError, counted, shown};
use crate::scene::particles::values::Layout;

/// Reads over all rows of an element.
pub(super) fn skip(cursor: &mut Cursor<'_>, element: &Element, format: Format) -> Result<(), ReadError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    let what = format!("element `{}`", element.name);
    if let (Some(row), Format::Binary(_)) = (fixed_row(element), format) {
        return cursor.take(element.rows.saturating_mul(row), &what).map(|_| ());
    }
    for _ in 0..element.rows {
        for property in &element.properties {
            skip_property(cursor, property, format, &what)?;
        }
    }
    Ok(())
}

/// The scalar properties of an element, each a column of its own.
pub(super) fn columns(cursor: &mut Cursor<'_>, element: &Element, format: Format) -> Result<Vec<Values>, ReadError> {
    let what = format!("element `{}`", element.name);
    match (format, fixed_row(element)) {
        (Format::Binary(order), Some(row)) => fixed_columns(cursor, element, order, row, &what),
        _ => row_by_row(cursor, element, format, &what),
    }
}

/// Bytes of a row if there is no list in it.
fn fixed_row(element: &Element) -> Option<usize> {
    element.properties.iter().try_fold(0, |sum, property| match property {
        Property::Scalar(_, kind) => Some(sum + kind.size()),
        Property::List(..) => None,
    })
}

fn fixed_columns(
    cursor: &mut Cursor<'_>,
    element: &Element,
    order: Order,
    stride: usize,
    what: &str,
) -> Result<Vec<Values>, ReadError> {
    let bytes = cursor.take(element.rows.saturating_mul(stride), what)?;
    let mut start = 0;
    let mut columns = Vec::new();
    // Without properties there is nothing to bound the number of rows.
    for property in &element.properties {
        let Property::Scalar(_, kind) = property else { continue };
        let layout = Layout { start, stride, components: 1 };
        columns.push(Values::gather(*kind, bytes, layout, element.rows, order));
        start += kind.size();
    }
    Ok(columns)
}

fn row_by_row(
    cursor: &mut Cursor<'_>,
    element: &Element,
    format: Format,
    what: &str,
) -> Result<Vec<Values>, ReadError> {
    let mut columns: Vec<Values> = element.properties.iter().filter_map(scalar_kind).map(Values::empty).collect();
    if element.properties.is_empty() {
        return Ok(columns);
    }
    let names: Vec<String> = element.properties.iter().map(|p| format!("property `{}`", p.name())).collect();
    for _ in 0..element.rows {
        let mut column = 0;
        for (property, name) in element.properties.iter().zip(&names) {
            match (property, columns.get_mut(column)) {
                (Property::Scalar(_, kind), Some(values)) => {
                    push(cursor, values, *kind, format, name)?;
                    column += 1;
                }
                _ => skip_property(cursor, property, format, what)?,
            }
        }
    }
    Ok(columns)
}

fn scalar_kind(property: &Property) -> Option<Kind> {
    match property {
        Property::Scalar(_, kind) => Some(*kind),
        Property::List(..) => None,
    }
}

/// Appends one number.
pub(super) fn push(
    cursor: &mut Cursor<'_>,
    values: &mut Values,
    kind: Kind,
    format: Format,
    what: &str,
) -> Result<(), ReadError> {
    match format {
        Format::Binary(order) => {
            let bytes = cursor.take(kind.size(), what)?;
            values.extend(bytes, order);
            Ok(())
        }
        Format::Text => {
            let word = word(cursor, what)?;
            if values.push_text(word) {
                return Ok(());
            }
            let message = format!("{what}: expected a number of type {}, found {}", kind.name(), shown(word));
            Err(cursor.text_error_before(word, message))
        }
    }
}

/// Reads over one property of a row.
pub(super) fn skip_property(
    cursor: &mut Cursor<'_>,
    property: &Property,
    format: Format,
    what: &str,
) -> Result<(), ReadError> {
    match (property, format) {
        (Property::Scalar(..), Format::Text) => word(cursor, what).map(|_| ()),
        (Property::Scalar(_, kind), Format::Binary(_)) => cursor.take(kind.size(), what).map(|_| ()),
        (Property::List(name, length, items), _) => {
            let count = list_length(cursor, name, *length, format, what)?;
            match format {
                Format::Text => cursor.skip_words(count, what),
                Format::Binary(_) => cursor.take(count.saturating_mul(items.size()), what).map(|_| ()),
            }
        }
    }
}

/// The number of items of a list, which follow it.
pub(super) fn list_length(
    cursor: &mut Cursor<'_>,
    name: &str,
    kind: Kind,
    format: Format,
    what: &str,
) -> Result<usize, ReadError> {
    match format {
        Format::Text => {
            let length = word(cursor, what)?;
            let message = || format!("list `{name}`: expected its length, found {}", shown(length));
            count_of(length).ok_or_else(|| cursor.text_error_before(length, message()))
        }
        Format::Binary(order) => {
            let mut value = Values::empty(kind);
            value.extend(cursor.take(kind.size(), what)?, order);
            let length = value.uniform().unwrap_or(-1.0);
            if length < 0.0 {
                return Err(cursor.byte_error(format!("list `{name}`: a length of {length}")));
            }
            Ok(length as usize)
        }
    }
}

fn word<'a>(cursor: &mut Cursor<'a>, what: &str) -> Result<&'a [u8], ReadError> {
    match cursor.word() {
        Some(word) => Ok(word),
        None => Err(cursor.text_error(format!("{what}: expected {}, found the end of the file", counted(1, "number")))),
    }
}
