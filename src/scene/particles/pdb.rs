//! PDB, the cache of a modeller's particles: a header, then a channel after the other, each with its
//! name, its type and a row of 4-byte numbers for each particle. The headers are structs as a
//! program had them in memory, with pointers of 4 or of 8 bytes.

use super::Attribute;
use super::error::{ReadError, shown};
use super::finish::Found;
use super::group::means_position;
use super::stream::Stream;
use super::values::{Kind, Layout, Order, Values};

const MAGIC: u32 = 670;

/// Where the fields of the structs lie, which the width of a pointer decides.
struct Widths {
    header: usize,
    channel: usize,
    /// In a channel.
    kind: usize,
    data: usize,
}

const NARROW: Widths = Widths { header: 60, channel: 36, kind: 4, data: 20 };
const WIDE: Widths = Widths { header: 64, channel: 56, kind: 8, data: 24 };
/// What stands before each channel.
const CHANNEL_MARK: usize = 6;

pub(super) fn read(bytes: &[u8]) -> Result<Found, ReadError> {
    let mut stream = Stream::new(bytes);
    let start = stream.peek(WIDE.header + CHANNEL_MARK + WIDE.channel)?.to_vec();
    let order = match start.get(..4) {
        Some(magic) if word(magic, Order::Little) == MAGIC => Order::Little,
        Some(magic) if word(magic, Order::Big) == MAGIC => Order::Big,
        _ => {
            let found = shown(&start[..start.len().min(4)]);
            return Err(
                stream.error_at(0, format!("expected the number {MAGIC}, which begins a PDB file, found {found}"))
            );
        }
    };
    let field = |at: usize| start.get(at..at + 4).map_or(0, |bytes| word(bytes, order));
    let (rows, channels) = (field(16) as usize, field(20));
    // The first channel's type tells which width puts it where it is.
    let is_type = |widths: &Widths| (1..=5).contains(&field(widths.header + CHANNEL_MARK + widths.kind));
    let widths = if !is_type(&NARROW) && is_type(&WIDE) { WIDE } else { NARROW };
    stream.take(widths.header, "the header")?;
    let mut attributes = Vec::new();
    let mut notes = Vec::new();
    for _ in 0..channels {
        attributes.extend(channel(&mut stream, &widths, rows, order, &mut notes)?);
    }
    let position = attributes.iter().position(|a| a.components == 3 && means_position(&a.name));
    let Some(position) = position else {
        return Err(stream.error("expected a channel `position` of 3 numbers, found none"));
    };
    let mut found = Found::new(attributes.remove(position).values);
    (found.attributes, found.notes) = (attributes, notes);
    stream.check_end()?;
    Ok(found)
}

fn channel(
    stream: &mut Stream<'_>,
    widths: &Widths,
    rows: usize,
    order: Order,
    notes: &mut Vec<String>,
) -> Result<Option<Attribute>, ReadError> {
    stream.take(CHANNEL_MARK, "a channel")?;
    let header = stream.take(widths.channel, "a channel")?;
    let kind = header.get(widths.kind..widths.kind + 4).map_or(0, |bytes| word(bytes, order));
    let mut name = Vec::new();
    loop {
        match stream.take(1, "a channel's name")? {
            [0] => break,
            byte => name.extend_from_slice(byte),
        }
    }
    let name = String::from_utf8_lossy(&name).into_owned();
    let what = format!("channel `{name}`");
    let width = word(stream.take(widths.data, &what)?.get(4..8).unwrap_or_default(), order) as usize;
    let bytes = stream.take(rows.saturating_mul(width), &what)?;
    let kind = match kind {
        1 | 2 => Kind::F32,
        3 => Kind::I32,
        _ => {
            notes.push(format!("attribute `{name}` is left out: it holds no numbers"));
            return Ok(None);
        }
    };
    let layout = Layout { start: 0, stride: width, components: width / kind.size() };
    if !width.is_multiple_of(kind.size()) {
        return Err(stream.error(format!("{what}: rows of {width} bytes are not of whole numbers")));
    }
    let values = Values::gather(kind, bytes, layout, rows, order);
    Ok(Some(Attribute { name, components: layout.components, values }))
}

fn word(bytes: &[u8], order: Order) -> u32 {
    let append = |sum: u32, byte: &u8| sum << 8 | u32::from(*byte);
    match order {
        Order::Big => bytes.iter().fold(0, append),
        Order::Little => bytes.iter().rev().fold(0, append),
    }
}
