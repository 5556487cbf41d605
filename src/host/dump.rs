//! Buffers as files: particles and meshes for other programs, tables for people, bytes for all.

use std::fmt::Write as _;
use std::path::Path;

use half::f16;
use serde_json::{Value as Json, json};

use crate::scene::convert::{Lane, lanes};
use crate::shader::reflect::{Scalar, Type};

/// What a buffer's file name asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DumpKind {
    /// Points with all their numbers; needs a position.
    Ply,
    /// Points; needs a position.
    Obj,
    /// A line for each item.
    Csv,
    /// An object for each item.
    Json,
    /// The bytes as they lie.
    Bin,
}

/// The ends of file names that buffers may be written to.
pub const ENDS: &[(&str, DumpKind)] = &[
    ("ply", DumpKind::Ply),
    ("obj", DumpKind::Obj),
    ("csv", DumpKind::Csv),
    ("json", DumpKind::Json),
    ("bin", DumpKind::Bin),
];

impl DumpKind {
    pub fn of(path: &Path) -> Option<Self> {
        let end = path.extension()?.to_str()?.to_ascii_lowercase();
        ENDS.iter().find(|(known, _)| *known == end).map(|(_, kind)| *kind)
    }
}

/// Items as they came from the device.
#[derive(Clone, Debug)]
pub struct Items<'a> {
    /// From the first item on, without the header of a counted buffer.
    pub bytes: &'a [u8],
    /// Bytes from one item to the next.
    pub stride: usize,
    /// How many items there are; those beyond the bytes are left out.
    pub count: usize,
    /// What an item is; absent: unknown, and each 4 bytes are a `u32`.
    pub item: Option<&'a Type>,
}

/// A number of each item, by name.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    lane: Lane,
}

/// The items as the bytes of a file.
///
/// # Errors
/// If the format needs a position and the items have none; the text says so.
pub fn write(items: &Items<'_>, kind: DumpKind) -> Result<Vec<u8>, String> {
    let columns = columns(items);
    match kind {
        DumpKind::Bin => Ok(items.bytes[..items.bytes.len().min(items.stride * items.count)].to_vec()),
        DumpKind::Csv => Ok(csv(items, &columns)),
        DumpKind::Json => Ok(objects(items, &columns)),
        DumpKind::Ply => Ok(ply(items, &columns, position(items)?)),
        DumpKind::Obj => Ok(obj(items, position(items)?)),
    }
}

/// A number of an item.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    Float(f32),
    Int(i64),
}

/// Items as rows of numbers under names.
#[derive(Clone, Debug)]
pub struct Table {
    columns: Vec<Column>,
}

impl Table {
    pub fn of(items: &Items<'_>) -> Self {
        Self { columns: columns(items) }
    }

    /// The names of an item's numbers.
    pub fn headings(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|c| c.name.as_str())
    }

    /// The numbers of an item, whose bytes these are.
    pub fn cells<'a>(&'a self, row: &'a [u8]) -> impl Iterator<Item = Cell> + 'a {
        self.columns.iter().map(|c| match c.lane {
            (at, Scalar::F32) => Cell::Float(f32::from_le_bytes(word(row, at))),
            (at, Scalar::F16) => Cell::Float(half_at(row, at)),
            (at, Scalar::I32) => Cell::Int(i32::from_le_bytes(word(row, at)).into()),
            (at, Scalar::U32 | Scalar::Other) => Cell::Int(u32::from_le_bytes(word(row, at)).into()),
        })
    }
}

fn columns(items: &Items<'_>) -> Vec<Column> {
    let Some(ty) = items.item else {
        return (0..items.stride as u32 / 4)
            .map(|i| Column { name: format!("u{i}"), lane: (i * 4, Scalar::U32) })
            .collect();
    };
    let names = names(ty, "");
    let named = names.into_iter().zip(lanes(ty));
    named.map(|(name, lane)| Column { name: if name.is_empty() { "value".into() } else { name }, lane }).collect()
}

/// The names of a type's numbers, in the order of [`lanes`].
fn names(ty: &Type, prefix: &str) -> Vec<String> {
    let below = |name: &str| if prefix.is_empty() { name.to_owned() } else { format!("{prefix}.{name}") };
    match ty {
        Type::Scalar(_) | Type::Atomic(_) => vec![prefix.to_owned()],
        Type::Vector { components, .. } => {
            ["x", "y", "z", "w"].iter().take(*components as usize).map(|c| below(c)).collect()
        }
        Type::Matrix { columns, rows, .. } => (0..*columns)
            .flat_map(|c| (0..*rows).map(move |r| (c, r)))
            .map(|(c, r)| below(&format!("{c}.{r}")))
            .collect(),
        Type::Array { element, count, .. } => {
            (0..count.unwrap_or(0)).flat_map(|i| names(element, &below(&i.to_string()))).collect()
        }
        Type::Struct { members, .. } => members.iter().flat_map(|m| names(&m.ty, &below(&m.name))).collect(),
    }
}

/// The three numbers that say where an item is: a member `position`, or the item itself.
fn position(items: &Items<'_>) -> Result<[Lane; 3], String> {
    let found = items.item.and_then(|ty| {
        let at_front = || Some((0, ty)).filter(|_| is_triple(ty));
        let member = match ty {
            Type::Struct { members, .. } => {
                let named = members.iter().find(|m| ["position", "pos", "p", "center"].contains(&&*m.name));
                named.map(|m| (m.offset, &m.ty))
            }
            _ => None,
        };
        let (offset, ty) = member.or_else(at_front)?;
        let all: Vec<Lane> = lanes(ty).into_iter().map(|(at, s)| (at + offset, s)).collect();
        all.get(..3)?.try_into().ok().filter(|l: &[Lane; 3]| l.iter().all(|(_, s)| *s == Scalar::F32))
    });
    found.ok_or_else(|| {
        let what = items
            .item
            .map_or_else(|| "items of an unknown type".to_owned(), |ty| format!("items of type `{}`", ty.wgsl()));
        format!("{what} have no `position`")
    })
}

fn is_triple(ty: &Type) -> bool {
    match ty {
        Type::Vector { components, .. } => *components >= 3,
        Type::Struct { members, .. } => {
            members.len() >= 3 && ["x", "y", "z"].iter().zip(members).all(|(n, m)| *n == &*m.name)
        }
        _ => false,
    }
}

fn rows<'a>(items: &'a Items<'_>) -> impl Iterator<Item = &'a [u8]> {
    items.bytes.chunks_exact(items.stride.max(1)).take(items.count)
}

fn word(row: &[u8], at: u32) -> [u8; 4] {
    let at = at as usize;
    row.get(at..at + 4).and_then(|b| b.try_into().ok()).unwrap_or_default()
}

fn half_at(row: &[u8], at: u32) -> f32 {
    let at = at as usize;
    row.get(at..at + 2).map_or(0.0, |b| f16::from_le_bytes([b[0], b[1]]).to_f32())
}

fn csv(items: &Items<'_>, columns: &[Column]) -> Vec<u8> {
    let header: Vec<&str> = columns.iter().map(|c| c.name.as_str()).collect();
    let mut text = header.join(",") + "\n";
    for row in rows(items) {
        for (index, Column { lane: (at, scalar), .. }) in columns.iter().enumerate() {
            let comma = if index == 0 { "" } else { "," };
            _ = match scalar {
                Scalar::F32 => write!(text, "{comma}{:?}", f32::from_le_bytes(word(row, *at))),
                Scalar::I32 => write!(text, "{comma}{}", i32::from_le_bytes(word(row, *at))),
                Scalar::F16 => write!(text, "{comma}{:?}", half_at(row, *at)),
                Scalar::U32 | Scalar::Other => write!(text, "{comma}{}", u32::from_le_bytes(word(row, *at))),
            };
        }
        text.push('\n');
    }
    text.into_bytes()
}

fn objects(items: &Items<'_>, columns: &[Column]) -> Vec<u8> {
    let number = |row: &[u8], (at, scalar): Lane| match scalar {
        // JSON has no NaN and no infinity: null.
        Scalar::F32 => json!(f32::from_le_bytes(word(row, at))),
        Scalar::F16 => json!(half_at(row, at)),
        Scalar::I32 => json!(i32::from_le_bytes(word(row, at))),
        Scalar::U32 | Scalar::Other => json!(u32::from_le_bytes(word(row, at))),
    };
    let object = |row: &[u8]| Json::Object(columns.iter().map(|c| (c.name.clone(), number(row, c.lane))).collect());
    Json::Array(rows(items).map(object).collect()).to_string().into_bytes()
}

fn obj(items: &Items<'_>, position: [Lane; 3]) -> Vec<u8> {
    let mut text = String::new();
    for row in rows(items) {
        let [x, y, z] = position.map(|(at, _)| f32::from_le_bytes(word(row, at)));
        _ = writeln!(text, "v {x} {y} {z}");
    }
    text.into_bytes()
}

/// Binary PLY: x, y, z first, then every other number under its name.
fn ply(items: &Items<'_>, columns: &[Column], position: [Lane; 3]) -> Vec<u8> {
    let others: Vec<&Column> = columns.iter().filter(|c| !position.contains(&c.lane)).collect();
    let count = rows(items).count();
    let mut out = format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n").into_bytes();
    for name in ["x", "y", "z"] {
        out.extend_from_slice(format!("property float {name}\n").as_bytes());
    }
    for column in &others {
        let kind = match column.lane.1 {
            Scalar::F32 | Scalar::F16 => "float",
            Scalar::I32 => "int",
            Scalar::U32 | Scalar::Other => "uint",
        };
        out.extend_from_slice(format!("property {kind} {}\n", column.name.replace('.', "_")).as_bytes());
    }
    out.extend_from_slice(b"end_header\n");
    for row in rows(items) {
        let all = position.iter().copied().chain(others.iter().map(|c| c.lane));
        for (at, scalar) in all {
            match scalar {
                Scalar::F16 => out.extend_from_slice(&half_at(row, at).to_le_bytes()),
                _ => out.extend_from_slice(&word(row, at)),
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::{FileId, Span};
    use crate::scene::particles;
    use crate::shader::reflect::Member;

    fn member(name: &str, offset: u32, ty: Type) -> Member {
        Member { name: name.into(), offset, ty, span: Span::new(FileId(0), 0, 0) }
    }

    /// `{ position: vec3<f32>, id: u32 }`.
    fn item() -> Type {
        let members = vec![
            member("position", 0, Type::Vector { components: 3, scalar: Scalar::F32 }),
            member("id", 12, Type::Scalar(Scalar::U32)),
        ];
        Type::Struct { name: "Drop".into(), members, size: 16 }
    }

    fn bytes() -> Vec<u8> {
        let row = |p: [f32; 3], id: u32| [bytemuck::cast_slice(&p), bytemuck::bytes_of(&id)].concat();
        [row([1.0, 2.5, -3.0], 7), row([0.0, 0.5, 4.0], 9), row([9.0; 3], 0)].concat()
    }

    fn dump(kind: DumpKind) -> Vec<u8> {
        write(&Items { bytes: &bytes(), stride: 16, count: 2, item: Some(&item()) }, kind).expect("a dump")
    }

    #[test]
    fn text_formats_hold_the_items_that_count() {
        let text = |kind| String::from_utf8(dump(kind)).expect("text");
        assert_eq!(text(DumpKind::Csv), "position.x,position.y,position.z,id\n1.0,2.5,-3.0,7\n0.0,0.5,4.0,9\n");
        assert_eq!(text(DumpKind::Obj), "v 1 2.5 -3\nv 0 0.5 4\n");
        let first = r#"[{"id":7,"position.x":1.0,"position.y":2.5,"position.z":-3.0},"#;
        assert!(text(DumpKind::Json).starts_with(first), "{}", text(DumpKind::Json));
        assert_eq!(dump(DumpKind::Bin), bytes()[..32]);
    }

    #[test]
    fn a_dumped_ply_reads_back_as_particles() {
        let set = particles::read(Path::new("a.ply"), &dump(DumpKind::Ply)).expect("particles");
        assert_eq!(*set.positions(), [[1.0, 2.5, -3.0], [0.0, 0.5, 4.0]]);
        assert_eq!(set.attribute("id").map(particles::Attribute::to_u32), Some(vec![7, 9]));
    }

    #[test]
    fn items_without_a_position_are_refused_as_points() {
        let items = Items { bytes: &[0; 8], stride: 4, count: 2, item: Some(&Type::Scalar(Scalar::F32)) };
        assert_eq!(write(&items, DumpKind::Ply), Err("items of type `f32` have no `position`".into()));
        assert!(write(&items, DumpKind::Csv).is_ok_and(|csv| csv == b"value\n0.0\n0.0\n"));
    }

    #[test]
    fn items_of_unknown_type_are_words() {
        let items = Items { bytes: bytemuck::cast_slice(&[1u32, 2, 3, 4]), stride: 8, count: 2, item: None };
        assert!(write(&items, DumpKind::Csv).is_ok_and(|csv| csv == b"u0,u1\n1,2\n3,4\n"));
    }
}
