//! The old generation: `Bgeo`, `V`, version 5, and all numbers big endian.
//!
//! A header counts points, primitives and attributes; the point attributes' names and types
//! follow, then a row for each point: `x`, `y`, `z`, `w` and its attributes, 4 bytes a number.
//! Detail attributes (values for the whole file) come last, and are read only if no primitives
//! are in between.

use super::stream::Stream;
use crate::scene::particles::Attribute;
use crate::scene::particles::error::{ReadError, counted, shown};
use crate::scene::particles::finish::Found;
use crate::scene::particles::values::{Kind, Layout, Order, Values};

/// An attribute as its definition tells it.
struct Definition {
    name: String,
    components: usize,
    /// None for indices into a list of strings.
    kind: Option<Kind>,
}

pub(super) fn read(stream: &mut Stream<'_>) -> Result<Found, ReadError> {
    let counts = header(stream)?;
    let mut notes = Vec::new();
    let definitions = definitions(stream, counts.point_attributes)?;
    let numbers_per_row = definitions.iter().map(|d| d.components).sum::<usize>() + 4;
    let stride = numbers_per_row * 4;
    let size = counts.points.saturating_mul(stride);
    let what = format!("{} of {stride} bytes", counted(counts.points, "point"));
    let rows = stream.take(size, &what)?;

    let gather = |start: usize, components: usize, kind: Kind| {
        Values::gather(kind, rows, Layout { start, stride, components }, counts.points, Order::Big)
    };
    let mut found = Found::new(gather(0, 3, Kind::F32));
    let weights = gather(12, 1, Kind::F32);
    if !weights.is_empty() && weights.uniform() != Some(1.0) {
        notes.push("some positions have a weight other than 1, which is not used".to_owned());
    }
    let mut start = 16;
    for Definition { name, components, kind } in definitions {
        match kind {
            Some(kind) => {
                let values = gather(start, components, kind);
                found.attributes.push(Attribute { name, components, values });
            }
            None => notes.push(format!("attribute `{name}` is left out: it holds text")),
        }
        start += components * 4;
    }
    if counts.primitives == 0 && counts.detail_attributes > 0 {
        found.globals = details(stream, &counts)?;
    }
    found.notes = notes;
    Ok(found)
}

struct Counts {
    points: usize,
    primitives: usize,
    point_attributes: usize,
    vertex_attributes: usize,
    primitive_attributes: usize,
    detail_attributes: usize,
}

fn header(stream: &mut Stream<'_>) -> Result<Counts, ReadError> {
    let version = integer(stream, "the version")?;
    if version != 5 {
        return Err(stream.error_at(5, format!("expected version 5, found {version}")));
    }
    let points = count(stream, "the number of points")?;
    let primitives = count(stream, "the number of primitives")?;
    count(stream, "the number of point groups")?;
    count(stream, "the number of primitive groups")?;
    Ok(Counts {
        points,
        primitives,
        point_attributes: count(stream, "the number of point attributes")?,
        vertex_attributes: count(stream, "the number of vertex attributes")?,
        primitive_attributes: count(stream, "the number of primitive attributes")?,
        detail_attributes: count(stream, "the number of detail attributes")?,
    })
}

fn definitions(stream: &mut Stream<'_>, number: usize) -> Result<Vec<Definition>, ReadError> {
    let mut definitions = Vec::new();
    for _ in 0..number {
        definitions.push(definition(stream)?);
    }
    Ok(definitions)
}

fn definition(stream: &mut Stream<'_>) -> Result<Definition, ReadError> {
    let name = string(stream, "an attribute's name")?;
    let what = format!("attribute `{name}`");
    let components = short(stream, &what)?;
    let at = stream.offset();
    let kind = match integer(stream, &what)? {
        0 | 5 => Some(Kind::F32),
        1 => Some(Kind::I32),
        4 => None,
        2 => return Err(stream.error_at(at, format!("{what}: strings in rows are not known"))),
        other => return Err(stream.error_at(at, format!("{what}: expected type 0, 1, 4 or 5, found {other}"))),
    };
    match kind {
        Some(_) => {
            stream.take(components * 4, &what)?;
        }
        None => {
            for _ in 0..count(stream, &what)? {
                string(stream, &what)?;
            }
        }
    }
    Ok(Definition { name, components, kind })
}

/// Single numbers among the values for the whole file.
fn details(stream: &mut Stream<'_>, counts: &Counts) -> Result<Vec<(String, f64)>, ReadError> {
    // Without primitives these have definitions but no rows.
    definitions(stream, counts.vertex_attributes)?;
    definitions(stream, counts.primitive_attributes)?;
    let mut globals = Vec::new();
    let definitions = definitions(stream, counts.detail_attributes)?;
    for Definition { name, components, kind } in definitions {
        let bytes = stream.take(components * 4, &format!("detail attribute `{name}`"))?;
        if let (Some(kind), 1) = (kind, components) {
            let layout = Layout { start: 0, stride: 4, components };
            globals.extend(Values::gather(kind, bytes, layout, 1, Order::Big).uniform().map(|value| (name, value)));
        }
    }
    Ok(globals)
}

fn integer(stream: &mut Stream<'_>, what: &str) -> Result<i32, ReadError> {
    let bytes = stream.take(4, what)?;
    Ok(bytes.iter().fold(0, |sum, &byte| sum << 8 | i32::from(byte)))
}

fn count(stream: &mut Stream<'_>, what: &str) -> Result<usize, ReadError> {
    let at = stream.offset();
    let number = integer(stream, what)?;
    usize::try_from(number).map_err(|_| stream.error_at(at, format!("expected {what}, found {number}")))
}

fn short(stream: &mut Stream<'_>, what: &str) -> Result<usize, ReadError> {
    let bytes = stream.take(2, what)?;
    Ok(bytes.iter().fold(0, |sum, &byte| sum << 8 | usize::from(byte)))
}

fn string(stream: &mut Stream<'_>, what: &str) -> Result<String, ReadError> {
    let length = short(stream, what)?;
    let bytes = stream.take(length, what)?;
    let text = String::from_utf8_lossy(bytes);
    if text.contains('\0') {
        let message = format!("{what}: expected text, found {}", shown(bytes));
        return Err(stream.error(message));
    }
    Ok(text.into_owned())
}
