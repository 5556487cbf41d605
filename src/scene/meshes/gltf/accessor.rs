//! Numbers in the buffers of a glTF file. Every range is checked before a byte is read, and
//! nothing is copied that is not asked for.

use std::borrow::Cow;
use std::fmt::Display;

use super::container::{self, Address};
use super::document::{Accessor, Buffer, Document, Sparse};
use crate::scene::meshes::bundle::Bundle;
use crate::scene::meshes::report::{Report, counted, shown};

/// A document with the bytes of its buffers.
pub struct Data<'a> {
    pub document: &'a Document,
    /// Absent where a buffer is not there, which was reported.
    buffers: Vec<Option<Cow<'a, [u8]>>>,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

/// The elements of an accessor: checked, not yet read.
pub struct Elements<'a> {
    pub count: usize,
    component: Component,
    is_normalized: bool,
    width: usize,
    /// Absent: all are 0 but for the sparse ones.
    dense: Option<Rows<'a>>,
    sparse: Option<(Rows<'a>, Component, Rows<'a>)>,
}

/// Equally spaced rows, all of them within their bytes.
#[derive(Clone, Copy)]
struct Rows<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

impl<'a> Data<'a> {
    pub fn open(document: &'a Document, binary: Option<&'a [u8]>, bundle: &'a Bundle, report: &mut Report) -> Self {
        let buffers = document.buffers.iter().enumerate();
        let buffers = buffers
            .map(|(index, buffer)| {
                let binary = if index == 0 { binary } else { None };
                open_buffer(buffer, binary, bundle, &format!("buffer {index}"), report)
            })
            .collect();
        Self { document, buffers }
    }

    /// The bytes of a buffer view; none if it is not there, which is reported.
    pub fn view(&self, index: usize, user: &dyn Display, report: &mut Report) -> Option<&[u8]> {
        let Some(view) = self.document.buffer_views.get(index) else {
            report.error(user, format!("there is no buffer view {index}"));
            return None;
        };
        let place = format!("buffer view {index}");
        let Some(buffer) = self.buffers.get(view.buffer) else {
            report.error(place, format!("there is no buffer {}", view.buffer));
            return None;
        };
        let buffer = buffer.as_deref()?;
        let range = view.byte_offset.checked_add(view.byte_length).and_then(|end| buffer.get(view.byte_offset..end));
        if range.is_none() {
            let (start, length, has) = (view.byte_offset, view.byte_length, buffer.len());
            report.error(
                place,
                format!("{length} bytes from byte {start} of buffer {} are wanted, which has {has}", view.buffer),
            );
        }
        range
    }

    /// The elements of an accessor with one of `shapes`, of integers that count if `is_index`.
    pub fn elements(
        &self,
        index: usize,
        shapes: &[&str],
        user: &dyn Display,
        report: &mut Report,
    ) -> Option<Elements<'_>> {
        let Some(accessor) = self.document.accessors.get(index) else {
            report.error(user, format!("there is no accessor {index}"));
            return None;
        };
        let place = format!("accessor {index}");
        if !shapes.contains(&accessor.shape.as_str()) {
            let expected = shapes.join(" or ");
            report.error(user, format!("{place} is {}, and {expected} is expected", shown(&accessor.shape)));
            return None;
        }
        let component = component(accessor.component_type, &place, report)?;
        let size = width(&accessor.shape) * component.size();
        let dense = match accessor.buffer_view {
            Some(view) => Some(self.rows(view, accessor.byte_offset, size, accessor.count, &place, report)?),
            None => None,
        };
        let sparse = match &accessor.sparse {
            Some(sparse) => Some(self.sparse(accessor, sparse, size, &place, report)?),
            None => None,
        };
        if dense.is_none() && !report.take(accessor.count, &place) {
            // Zeros that no byte of the file stands for.
            return None;
        }
        let (is_normalized, width) = (accessor.normalized, width(&accessor.shape));
        Some(Elements { count: accessor.count, component, is_normalized, width, dense, sparse })
    }

    fn sparse(
        &self,
        accessor: &Accessor,
        sparse: &Sparse,
        size: usize,
        place: &str,
        report: &mut Report,
    ) -> Option<(Rows<'_>, Component, Rows<'_>)> {
        let (indices, values) = (&sparse.indices, &sparse.values);
        let place = format!("{place}, sparse");
        let kind = component(indices.component_type, &place, report)?;
        let places = self.rows(indices.buffer_view, indices.byte_offset, kind.size(), sparse.count, &place, report)?;
        let values = self.rows(values.buffer_view, values.byte_offset, size, sparse.count, &place, report)?;
        if !report.take(sparse.count, &place) {
            return None;
        }
        let mut next = 0;
        for row in 0..sparse.count {
            let index = kind.index(places.row(row));
            if index < next || index >= accessor.count as u64 {
                let count = counted(accessor.count, "element", "elements");
                report.error(place, format!("index {index} at {row} is out of order or beyond {count}"));
                return None;
            }
            next = index + 1;
        }
        Some((places, kind, values))
    }

    /// Rows of `size` bytes in a buffer view, at its stride.
    fn rows(
        &self,
        view: usize,
        offset: usize,
        size: usize,
        count: usize,
        place: &str,
        report: &mut Report,
    ) -> Option<Rows<'_>> {
        let bytes = self.view(view, &place, report)?;
        let stride = self.document.buffer_views.get(view).and_then(|v| v.byte_stride).filter(|stride| *stride > 0);
        let stride = stride.unwrap_or(size);
        if stride < size {
            report
                .error(place, format!("buffer view {view} has a stride of {stride} bytes, but an element has {size}"));
            return None;
        }
        if count == 0 {
            return Some(Rows { bytes: &[], stride, count });
        }
        let end = (count - 1).checked_mul(stride).and_then(|last| last.checked_add(size)?.checked_add(offset));
        match end.and_then(|end| bytes.get(offset..end)) {
            Some(bytes) => Some(Rows { bytes, stride, count }),
            None => {
                let what = format!("{} of {size} bytes, {stride} apart", counted(count, "element", "elements"));
                let has = bytes.len();
                report.error(
                    place,
                    format!("{what}, from byte {offset} do not fit into the {has} of buffer view {view}"),
                );
                None
            }
        }
    }
}

fn open_buffer<'a>(
    buffer: &'a Buffer,
    binary: Option<&'a [u8]>,
    bundle: &'a Bundle,
    place: &str,
    report: &mut Report,
) -> Option<Cow<'a, [u8]>> {
    let bytes = match (&buffer.uri, binary) {
        (None, Some(binary)) => Cow::Borrowed(binary),
        (None, None) => {
            report.error(place, "it has no `uri`, and the file has no binary chunk for it");
            return None;
        }
        (Some(uri), _) => match container::address(uri) {
            Address::Data(data) => match container::data(data) {
                Ok(bytes) => Cow::Owned(bytes),
                Err(message) => {
                    report.error(place, message);
                    return None;
                }
            },
            Address::File(name) => match bundle.other(&name) {
                Ok(bytes) => Cow::Borrowed(bytes),
                Err(why) => {
                    report.error_with_hint(place, format!("{} {why}", shown(&name)), why.hint());
                    return None;
                }
            },
        },
    };
    if bytes.len() < buffer.byte_length {
        report.error(place, format!("{} bytes are declared, there are {}", buffer.byte_length, bytes.len()));
        return None;
    }
    Some(bytes)
}

fn component(code: u32, place: &str, report: &mut Report) -> Option<Component> {
    Some(match code {
        5120 => Component::I8,
        5121 => Component::U8,
        5122 => Component::I16,
        5123 => Component::U16,
        5125 => Component::U32,
        5126 => Component::F32,
        _ => {
            report.error(place, format!("the component type is {code}; there are 5120 to 5123, 5125 and 5126"));
            return None;
        }
    })
}

/// Numbers of an element. Matrices are never asked for.
fn width(shape: &str) -> usize {
    match shape {
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        _ => 1,
    }
}

impl Component {
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number at the start of `bytes`, which has it.
    fn number(self, bytes: &[u8], is_normalized: bool) -> f32 {
        let (value, one) = match self {
            Self::I8 => (f32::from(first::<1>(bytes)[0] as i8), 127.0),
            Self::U8 => (f32::from(first::<1>(bytes)[0]), 255.0),
            Self::I16 => (f32::from(i16::from_le_bytes(first(bytes))), 32_767.0),
            Self::U16 => (f32::from(u16::from_le_bytes(first(bytes))), 65_535.0),
            Self::U32 => (u32::from_le_bytes(first(bytes)) as f32, 4_294_967_295.0),
            Self::F32 => return f32::from_le_bytes(first(bytes)),
        };
        if is_normalized { f32::max(value / one, -1.0) } else { value }
    }

    /// The number at the start of `bytes` as one that counts; what cannot is beyond every count.
    fn index(self, bytes: &[u8]) -> u64 {
        match self {
            Self::U8 => u64::from(first::<1>(bytes)[0]),
            Self::U16 => u64::from(u16::from_le_bytes(first(bytes))),
            Self::U32 => u64::from(u32::from_le_bytes(first(bytes))),
            Self::I8 | Self::I16 | Self::F32 => u64::MAX,
        }
    }
}

fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk().copied().unwrap_or([0; N])
}

impl<'a> Rows<'a> {
    fn row(&self, index: usize) -> &'a [u8] {
        self.bytes.get(index * self.stride..).unwrap_or_default()
    }

    /// Which row holds `wanted`, if rows hold growing numbers.
    fn find(&self, kind: Component, wanted: u64) -> Option<usize> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = usize::midpoint(low, high);
            match kind.index(self.row(middle)).cmp(&wanted) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Equal => return Some(middle),
                std::cmp::Ordering::Greater => high = middle,
            }
        }
        None
    }
}

impl Elements<'_> {
    /// The bytes of an element; none for zeros.
    fn bytes(&self, index: usize) -> Option<&[u8]> {
        let replaced = self.sparse.as_ref().and_then(|(places, kind, values)| {
            let row = places.find(*kind, index as u64)?;
            Some(values.row(row))
        });
        replaced.or_else(|| self.dense.map(|dense| dense.row(index)))
    }

    /// The first `N` numbers of an element, which has as many.
    pub fn get<const N: usize>(&self, index: usize) -> [f32; N] {
        let Some(bytes) = self.bytes(index) else { return [0.0; N] };
        let size = self.component.size();
        std::array::from_fn(|i| self.component.number(bytes.get(i * size..).unwrap_or_default(), self.is_normalized))
    }

    /// Numbers of an element.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Whether the numbers can be indices.
    pub fn can_count(&self) -> bool {
        matches!(self.component, Component::U8 | Component::U16 | Component::U32)
    }

    /// An element as an index.
    pub fn index(&self, index: usize) -> u64 {
        self.bytes(index).map_or(0, |bytes| self.component.index(bytes))
    }
}
