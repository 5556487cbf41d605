//! The element `face` of PLY, where surfaces are asked for.

use super::body::{self, columns, skip};
use super::{Element, Format, Found, Property, ReadError, Values, assemble, header};
use crate::scene::particles::cursor::Cursor;
use crate::scene::particles::polygons::{Cell, Polygons, indices};

/// Names of the list of a face's vertices.
const LISTS: &[&str] = &["vertex_indices", "vertex_index"];

/// The vertices of a file and the faces between them.
pub fn read_surface(bytes: &[u8]) -> Result<(Found, Polygons), ReadError> {
    let mut cursor = Cursor::of_text(bytes);
    let (format, elements) = header(&mut cursor)?;
    let (mut found, mut faces) = (None, None);
    for element in &elements {
        match element.name.as_str() {
            "vertex" if found.is_none() => {
                let columns = columns(&mut cursor, element, format)?;
                found = Some(assemble(&cursor, element, columns)?);
            }
            "face" if faces.is_none() => faces = list(&mut cursor, element, format)?,
            _ => skip(&mut cursor, element, format)?,
        }
    }
    let Some(found) = found else {
        return Err(cursor.text_error("the header has no element `vertex`"));
    };
    let mut polygons = Polygons::default();
    if let Some((corners, ends)) = faces {
        let corners = indices(&corners, found.position.len() / 3, "face", &ends)?;
        let starts = std::iter::once(0).chain(ends.iter().copied());
        for (start, end) in starts.zip(&ends) {
            polygons.push(Cell::Polygon, corners.get(start..*end).unwrap_or_default());
        }
    }
    Ok((found, polygons))
}

/// The corners of all faces, and where each ends; none if the element has no such list.
fn list(cursor: &mut Cursor<'_>, element: &Element, format: Format) -> Result<Option<(Values, Vec<usize>)>, ReadError> {
    let wanted = element.properties.iter().find_map(|property| match property {
        Property::List(name, _, items) if LISTS.contains(&name.as_str()) => Some((name, *items)),
        _ => None,
    });
    let Some((wanted, items)) = wanted else {
        skip(cursor, element, format)?;
        return Ok(None);
    };
    let what = format!("element `{}`", element.name);
    let (mut corners, mut ends) = (Values::empty(items), Vec::new());
    for _ in 0..element.rows {
        for property in &element.properties {
            match property {
                Property::List(name, length, items) if name == wanted => {
                    let count = body::list_length(cursor, name, *length, format, &what)?;
                    for _ in 0..count {
                        body::push(cursor, &mut corners, *items, format, &what)?;
                    }
                    ends.push(corners.len());
                }
                _ => body::skip_property(cursor, property, format, &what)?,
            }
        }
    }
    Ok(Some((corners, ends)))
}
