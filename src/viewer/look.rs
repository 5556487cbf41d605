//! What is looked at besides the picture: a resource, after a pass.

use crate::host::dump::{Cell, Items, Table};
use crate::plan::model::{Buffer, Object, ObjectKind, ObjectRef, Plan};
use crate::shader::reflect::Type;

/// A resource that a person looks at.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// Instance path of the resource.
    pub path: String,
    /// Instance path of the pass after which; absent: at the end of the frame.
    pub after: Option<String>,
    pub mip: u32,
    pub layer: u32,
}

/// What was seen of it.
#[derive(Debug)]
pub struct Seen {
    pub look: Look,
    /// Another number for other content.
    pub serial: u64,
    pub content: Result<SeenContent, String>,
}

#[derive(Debug)]
pub enum SeenContent {
    Texture(SeenTexture),
    Buffer(SeenBuffer),
}

#[derive(Debug)]
pub struct SeenTexture {
    pub width: u32,
    pub height: u32,
    pub channels: u32,
    pub format: String,
    pub texels: Vec<[f32; 4]>,
}

/// Items as they lie, with what they are.
#[derive(Debug)]
pub struct SeenBuffer {
    pub table: Table,
    /// How an item is declared.
    pub item: Option<String>,
    pub bytes: Vec<u8>,
    pub stride: usize,
    /// Items that count, and those that there is room for.
    pub count: usize,
    pub capacity: usize,
}

impl SeenBuffer {
    /// `bytes` with the header of a counted buffer.
    pub fn new(buffer: &Buffer, bytes: &[u8]) -> Self {
        let header = buffer.header as usize;
        let stride = buffer.stride.max(1) as usize;
        let capacity = usize::try_from(buffer.items).unwrap_or(usize::MAX);
        let body = bytes.get(header..).unwrap_or_default();
        let raw = bytes.get(..4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
        let counted = raw.filter(|_| buffer.counted).map_or(capacity, |raw| raw as usize);
        let count = counted.min(capacity).min(body.len() / stride);
        let items = Items { bytes: body, stride, count, item: buffer.item.as_ref() };
        let table = Table::of(&items);
        let item = buffer.item.as_ref().map(Type::wgsl);
        Self { table, item, stride, count, capacity, bytes: body.to_vec() }
    }

    /// The numbers of an item.
    pub fn row(&self, index: usize) -> Vec<Cell> {
        let row = self.bytes.get(index * self.stride..(index + 1) * self.stride).unwrap_or_default();
        self.table.cells(row).collect()
    }

    /// How many of the first items have a number that is none, or is infinite; and the first of them.
    pub fn bad(&self, most: usize) -> (usize, Option<usize>) {
        let is_bad = |index: &usize| self.row(*index).iter().any(|cell| is_bad(*cell));
        let mut found = (0..self.count.min(most)).filter(is_bad);
        let first = found.next();
        (usize::from(first.is_some()) + found.count(), first)
    }
}

pub fn is_bad(cell: Cell) -> bool {
    matches!(cell, Cell::Float(x) if !x.is_finite())
}

/// The object that an instance path names at the end of a frame.
pub fn find<'p>(plan: &'p Plan, path: &str) -> Option<(ObjectRef, &'p Object)> {
    let named = plan.names.get(path).copied();
    let found = named.or_else(|| plan.objects.iter().position(|o| o.path == path).map(|id| reference(plan, id)))?;
    Some((found, object(plan, found)?))
}

fn reference(plan: &Plan, id: usize) -> ObjectRef {
    let in_ring = |(ring, r): (usize, &crate::plan::model::Ring)| {
        r.objects.iter().position(|o| *o == id).map(|index| ObjectRef::Ring { ring, index })
    };
    plan.rings.iter().enumerate().find_map(in_ring).unwrap_or(ObjectRef::Fixed(id))
}

/// What a reference stands for before anything turned.
pub fn object(plan: &Plan, found: ObjectRef) -> Option<&Object> {
    let id = match found {
        ObjectRef::Fixed(id) => id,
        ObjectRef::Ring { ring, index } => *plan.rings.get(ring)?.objects.get(index)?,
    };
    plan.objects.get(id)
}

/// Every path that can be looked at, sorted.
pub fn paths(plan: &Plan) -> Vec<&str> {
    let own = plan.names.keys().map(String::as_str);
    let all = plan.objects.iter().filter(|o| o.lifetime.is_some()).map(|o| o.path.as_str());
    let mut paths: Vec<&str> = own.chain(all).filter(|path| find(plan, path).is_some()).collect();
    paths.sort_unstable();
    paths.dedup();
    paths
}

/// The passes that write an object, by index.
pub fn writers(plan: &Plan, object: ObjectRef) -> Vec<usize> {
    let writes = |pass: &crate::plan::model::Pass| pass.accesses.iter().any(|a| a.write && same(a.object, object));
    (0..plan.passes.len()).filter(|index| writes(&plan.passes[*index])).collect()
}

/// Whether both may stand for the same memory.
fn same(a: ObjectRef, b: ObjectRef) -> bool {
    match (a, b) {
        (ObjectRef::Ring { ring: a, .. }, ObjectRef::Ring { ring: b, .. }) => a == b,
        _ => a == b,
    }
}

/// A line about an object.
pub fn described(object: &Object) -> String {
    match &object.kind {
        ObjectKind::Texture(t) => {
            let layers = if t.layers > 1 { format!(", {} layers", t.layers) } else { String::new() };
            let mips = if t.mips > 1 { format!(", {} mips", t.mips) } else { String::new() };
            let samples = if t.samples > 1 { format!(", {} samples", t.samples) } else { String::new() };
            format!("{:?} {} x {}{layers}{mips}{samples}", t.format, t.width, t.height)
        }
        ObjectKind::Buffer(b) => {
            let kind = if b.counted { "counted, room for " } else { "" };
            format!("{kind}{} items of {} bytes", b.items, b.stride)
        }
    }
}
