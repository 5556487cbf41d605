//! PTC, a renderer's point cloud, versions 0 to 2, little endian: for each point a position, a normal
//! packed into two angles, a radius, and the channels that the header names.

use std::f32::consts::TAU;

use super::Attribute;
use super::error::{ReadError, counted, shown};
use super::finish::Found;
use super::stream::Stream;
use super::values::{Kind, Layout, Order, Values};

const MAGIC: &[u8] = b"pptc";
/// Bytes of a point before its channels: position, packed normal, radius.
const POINT: usize = 20;
/// More channels than any writer makes.
const MOST_CHANNELS: usize = 1024;

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    let mut stream = Stream::new(bytes);
    let magic = stream.take(4, "the magic number")?.to_vec();
    if magic != MAGIC {
        return Err(stream.error_at(0, format!("expected `pptc`, found {}", shown(&magic))));
    }
    let version = integer(&mut stream, "the version")?;
    if !(0..=2).contains(&version) {
        return Err(stream.error_at(4, format!("versions 0 to 2 are known, found {version}")));
    }
    let rows = count(&mut stream)?;
    // Bounds; from version 1 on four numbers more, from 2 on 33; two matrices; the picture's size.
    let further = [0, 4, 37][version as usize];
    stream.take((6 + further + 32 + 3) * 4, "the header")?;
    let channels = channels(&mut stream)?;
    if version >= 1 {
        stream.take(8, "the header")?;
    }
    let stride = POINT + 4 * channels.iter().map(|(_, width)| width).sum::<usize>();
    let what = format!("{} of {stride} bytes", counted(rows, "point"));
    let points = stream.take(rows.saturating_mul(stride), &what)?;
    let column = |kind: Kind, start: usize, components: usize| {
        Values::gather(kind, points, Layout { start, stride, components }, rows, Order::Little)
    };
    let mut found = Found::new(column(Kind::F32, 0, 3));
    let angles = column(Kind::U16, 12, 2).to_f32();
    let normals = Values::F32(angles.as_chunks::<2>().0.iter().flat_map(|angles| normal(*angles)).collect());
    found.attributes.push(Attribute { name: "normal".into(), components: 3, values: normals });
    found.attributes.push(Attribute { name: "radius".into(), components: 1, values: column(Kind::F32, 16, 1) });
    let mut start = POINT;
    for (name, components) in channels {
        let values = column(Kind::F32, start, components);
        found.attributes.push(Attribute { name, components, values });
        start += 4 * components;
    }
    stream.check_end()?;
    Ok(found)
}

/// The channels' names and how many numbers each has.
fn channels(stream: &mut Stream<'_>) -> Result<Vec<(String, usize)>, ReadError> {
    let at = stream.offset();
    let number = integer(stream, "the number of channels")?;
    let size = integer(stream, "the size of a point's channels")?;
    let Some(number) = usize::try_from(number).ok().filter(|n| *n <= MOST_CHANNELS) else {
        return Err(stream.error_at(at, format!("expected the number of channels, found {number}")));
    };
    let mut channels = Vec::new();
    for _ in 0..number {
        let at = stream.offset();
        let mut line = Vec::new();
        loop {
            match stream.take(1, "a channel's name")? {
                b"\n" => break,
                byte => line.extend_from_slice(byte),
            }
        }
        let text = String::from_utf8_lossy(&line).into_owned();
        let (kind, name) = text.trim().split_once(' ').unwrap_or((text.trim(), ""));
        let width = match kind {
            "float" => 1,
            "color" | "point" | "vector" | "normal" => 3,
            "matrix" => 16,
            _ => {
                let expected = "expected a type such as `float` or `color`";
                return Err(stream.error_at(at, format!("{expected}, found {}", shown(kind.as_bytes()))));
            }
        };
        channels.push((name.trim().to_owned(), width));
    }
    let sum: usize = channels.iter().map(|(_, width)| width).sum();
    if usize::try_from(size) != Ok(sum) {
        return Err(
            stream.error_at(at + 4, format!("the channels have {}, the header says {size}", counted(sum, "number")))
        );
    }
    Ok(channels)
}

/// A unit normal from its angle around z and its z, each as a fraction; both at their highest is none.
fn normal([angle, z]: [f32; 2]) -> [f32; 3] {
    const MOST: f32 = 65_535.0;
    if angle == MOST && z == MOST {
        return [0.0; 3];
    }
    let z = 2.0 * (z / MOST) - 1.0;
    let angle = TAU * (angle / MOST - 0.5);
    let across = (1.0 - z * z).max(0.0).sqrt();
    [across * angle.sin(), across * angle.cos(), z]
}

fn integer(stream: &mut Stream<'_>, what: &str) -> Result<i32, ReadError> {
    let bytes = stream.take(4, what)?;
    Ok(bytes.iter().rev().fold(0, |sum, &byte| sum << 8 | i32::from(byte)))
}

/// The number of points, which is stored as a float of 64 bits.
fn count(stream: &mut Stream<'_>) -> Result<usize, ReadError> {
    let at = stream.offset();
    let bytes = stream.take(8, "the number of points")?;
    let number = bytes.as_chunks().0.first().map_or(f64::NAN, |bytes| f64::from_le_bytes(*bytes));
    if number >= 0.0 && number <= f64::from(u32::MAX) && number.fract() == 0.0 {
        return Ok(number as usize);
    }
    Err(stream.error_at(at, format!("expected the number of points, found {number}")))
}
