//! XML VTK: the points of unstructured grids (`.vtu`) and polygonal data (`.vtp`) with their
//! point data, in one or several pieces. Arrays stand inline, as text or base64, or in the
//! appended section, raw or base64, in either byte order, plain or compressed by zlib or LZ4.

mod blocks;
mod document;

use super::Attribute;
use super::cursor::Cursor;
use super::error::ReadError;
use super::finish::{Found, names_radius};
use super::values::{Kind, Values};
use blocks::Blocks;
use document::{DataArray, Document, Piece};

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    // The reader of elements does not count a mark that the text begins with.
    let bytes = Cursor::of_text(bytes).rest();
    let document = document::parse(bytes)?;
    let mut blocks = Blocks::new(bytes, &document)?;
    let Some((first, others)) = document.pieces.split_first() else {
        return Err(ReadError::new("expected a `Piece`, found none").at(blocks.place(document.at)));
    };
    let mut found = piece(first, &mut blocks)?;
    for other in others {
        let more = piece(other, &mut blocks)?;
        found = joined(found, more);
    }
    found.globals = globals(&document, &mut blocks)?;
    Ok(found)
}

/// The points of one piece.
fn piece(piece: &Piece<'_>, blocks: &mut Blocks<'_>) -> Result<Found, ReadError> {
    let Some(points) = &piece.position else {
        return Err(ReadError::new("expected an array in `Points`, found none").at(blocks.place(piece.at)));
    };
    let mut found = match points.kind {
        Some(kind) if points.components == 3 => Found::new(values(points, kind, piece.points, blocks)?),
        _ => {
            let message = format!("expected points of 3 numbers, found {} components", points.components);
            return Err(ReadError::new(message).at(blocks.place(points.at)));
        }
    };
    for array in &piece.data {
        let DataArray { name, components, .. } = array;
        match array.kind {
            Some(kind) => {
                let values = values(array, kind, piece.points, blocks)?;
                found.attributes.push(Attribute { name: name.clone(), components: *components, values });
            }
            None => found.notes.push(format!("attribute `{name}` is left out: it holds text")),
        }
    }
    Ok(found)
}

/// The numbers of an array. An error is at the array's element unless it knows better.
fn values(array: &DataArray<'_>, kind: Kind, rows: usize, blocks: &mut Blocks<'_>) -> Result<Values, ReadError> {
    let decoded = match kind.bytes(rows, array.components) {
        // What follows no points may be anything that a writer calls empty.
        Ok(0) => Ok(Values::empty(kind)),
        Ok(size) => blocks.values(array, kind, size / kind.size()),
        Err(error) => Err(error),
    };
    decoded.map_err(|error| error.or_at(|| blocks.place(array.at)))
}

/// Two pieces as one: of their attributes, those that both have alike.
fn joined(mut all: Found, more: Found) -> Found {
    if let Err(other) = all.position.append(more.position) {
        let mut wide = all.position.to_f64();
        wide.extend(other.to_f64());
        all.position = Values::F64(wide);
    }
    let mut kept = Vec::with_capacity(all.attributes.len());
    let mut others = more.attributes;
    for mut attribute in all.attributes {
        let like = |o: &Attribute| o.name == attribute.name && o.components == attribute.components;
        let other = others.iter().position(like).map(|index| others.swap_remove(index));
        let joins = other.is_some_and(|other| attribute.values.append(other.values).is_ok());
        if joins {
            kept.push(attribute);
        } else {
            all.notes.push(format!("attribute `{}` is left out: not all pieces have it alike", attribute.name));
        }
    }
    all.attributes = kept;
    all
}

/// Single numbers for the whole file; of interest is only a radius.
fn globals(document: &Document<'_>, blocks: &mut Blocks<'_>) -> Result<Vec<(String, f64)>, ReadError> {
    let mut globals = Vec::new();
    for array in &document.fields {
        let (Some(kind), 1, true) = (array.kind, array.components, names_radius(&array.name)) else { continue };
        let value = values(array, kind, 1, blocks)?.uniform();
        globals.extend(value.map(|value| (array.name.clone(), value)));
    }
    Ok(globals)
}
