//! The old generation: `Bgeo`, `V`, version 5, and all numbers big endian.
//!
//! A header counts points, primitives and attributes; the point attributes' names and types
//! follow, then a row for each point: `x`, `y`, `z`, `w` and its attributes, 4 bytes a number.
//! Texts are numbers into a list that stands with the attribute's name.
//! Detail attributes (values for the whole file) come last, and are read only if all primitives
//! in between are lists of particles, whose size is known.

use super::numbered_texts;
use crate::scene::particles::Attribute;
use crate::scene::particles::error::{ReadError, counted, shown};
use crate::scene::particles::finish::Found;
use crate::scene::particles::stream::Stream;
use crate::scene::particles::values::{Kind, Layout, Order, Values};

/// An attribute as its definition tells it.
struct Definition {
    name: String,
    components: usize,
    kind: Kind,
    /// What the numbers stand for, if they stand for texts.
    texts: Option<Vec<String>>,
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
    for Definition { name, components, kind, texts } in definitions {
        let values = gather(start, components, kind);
        notes.extend(texts.map(|texts| numbered_texts(&name, &texts)));
        found.attributes.push(Attribute { name, components, values });
        start += components * 4;
    }
    // The points are whole: a fault behind them takes nothing but what stands there.
    match after_points(stream, &counts) {
        Ok(globals) => found.globals = globals,
        Err(wrong) => notes.push(format!("what follows the points is left out: {wrong}")),
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
    let (kind, has_texts) = match integer(stream, &what)? {
        0 | 5 => (Kind::F32, false),
        1 => (Kind::I32, false),
        4 => (Kind::I32, true),
        2 => return Err(stream.error_at(at, format!("{what}: strings in rows are not known"))),
        other => return Err(stream.error_at(at, format!("{what}: expected type 0, 1, 4 or 5, found {other}"))),
    };
    let mut texts = None;
    if has_texts {
        let list = texts.insert(Vec::new());
        for _ in 0..count(stream, &what)? {
            list.push(string(stream, &what)?);
        }
    } else {
        stream.take(components * 4, &what)?;
    }
    Ok(Definition { name, components, kind, texts })
}

/// A primitive that lists particles.
const PARTICLE_LIST: i32 = 0x8000;

/// Reads over the primitives; false if one has no size that is known, so that what follows
/// cannot be found.
fn skip_primitives(stream: &mut Stream<'_>, counts: &Counts) -> Result<bool, ReadError> {
    // Without primitives these have definitions but no rows.
    let of_vertices = definitions(stream, counts.vertex_attributes)?;
    let of_primitives = definitions(stream, counts.primitive_attributes)?;
    let row = of_primitives.iter().map(|d| d.components * 4).sum::<usize>();
    for _ in 0..counts.primitives {
        if integer(stream, "a primitive")? != PARTICLE_LIST || !of_vertices.is_empty() {
            return Ok(false);
        }
        let index = if counts.points >= 1 << 16 { 4 } else { 2 };
        let members = count(stream, "the length of a list of particles")?;
        stream.take(members.saturating_mul(index).saturating_add(row), "a list of particles")?;
    }
    Ok(true)
}

/// Single numbers for the whole file, where they can be found.
fn after_points(stream: &mut Stream<'_>, counts: &Counts) -> Result<Vec<(String, f64)>, ReadError> {
    if counts.detail_attributes == 0 || !skip_primitives(stream, counts)? {
        return Ok(Vec::new());
    }
    details(stream, counts)
}

/// Single numbers among the values for the whole file.
fn details(stream: &mut Stream<'_>, counts: &Counts) -> Result<Vec<(String, f64)>, ReadError> {
    let mut globals = Vec::new();
    let definitions = definitions(stream, counts.detail_attributes)?;
    for Definition { name, components, kind, texts } in definitions {
        let bytes = stream.take(components * 4, &format!("detail attribute `{name}`"))?;
        if components == 1 && texts.is_none() {
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
