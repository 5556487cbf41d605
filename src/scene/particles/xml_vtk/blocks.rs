//! From what a file encodes to numbers.

use std::borrow::Cow;
use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;

use super::document::{Appended, DataArray, Document, Format};
use crate::scene::particles::cursor::Cursor;
use crate::scene::particles::error::{Place, ReadError, counted};
use crate::scene::particles::values::{Kind, Layout, Order, Values};

/// How blocks are packed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Packing {
    Zlib,
    Lz4,
}

impl Packing {
    fn of(compressor: &str) -> Result<Self, ReadError> {
        match compressor {
            "vtkZLibDataCompressor" => Ok(Self::Zlib),
            "vtkLZ4DataCompressor" => Ok(Self::Lz4),
            other => {
                let name = other.strip_prefix("vtk").unwrap_or(other);
                let name = name.strip_suffix("DataCompressor").unwrap_or(name);
                let error = ReadError::new(format!("the data is compressed by {name}, which is not read"));
                Err(error.hint("save the file with zlib or LZ4 compression or with none"))
            }
        }
    }

    /// At most so many bytes are packed into one.
    fn most(self) -> usize {
        match self {
            Self::Zlib => 1032,
            Self::Lz4 => 256,
        }
    }
}

/// Reads arrays as a file's first element says that they are encoded.
pub(super) struct Blocks<'a> {
    bytes: &'a [u8],
    order: Order,
    header_size: usize,
    packing: Option<Packing>,
    appended: Option<Appended>,
    /// Bytes of the file that arrays may still claim. Arrays do not overlap, so that a small file
    /// cannot become many large arrays.
    unclaimed: usize,
}

/// Bytes as a file encodes them.
enum Encoded<'a> {
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

/// An error about an array.
fn array_error(array: &DataArray<'_>, message: &str, place: Option<Place>) -> ReadError {
    ReadError { place, ..ReadError::new(format!("array `{}`: {message}", array.name)) }
}

/// An error about so many bytes that an array should have.
fn size_error(array: &DataArray<'_>, expected: usize, found: &str, place: Option<Place>) -> ReadError {
    array_error(array, &format!("expected {}, found {found}", counted(expected, "byte")), place)
}

impl<'a> Blocks<'a> {
    pub fn new(bytes: &'a [u8], document: &Document<'_>) -> Result<Self, ReadError> {
        let packing = document.compressor.as_deref().map(Packing::of).transpose();
        let packing = packing.map_err(|error| error.or_at(|| Place::in_text(bytes, document.at)))?;
        let Document { order, header_size, appended, .. } = *document;
        Ok(Self { bytes, order, header_size, packing, appended, unclaimed: bytes.len() })
    }

    /// The line and column of a byte of the elements.
    pub fn place(&self, at: usize) -> Place {
        Place::in_text(self.bytes, at)
    }

    /// The numbers of an array, which must be `count`.
    pub fn values(&mut self, array: &DataArray<'_>, kind: Kind, count: usize) -> Result<Values, ReadError> {
        let (encoded, place) = match array.format {
            Format::Text(start, text) => return self.text(array, kind, count, start, text.len()),
            Format::Base64(text) => (Encoded::Base64(text.as_bytes()), None),
            Format::Appended(offset) => self.appended(array, offset)?,
        };
        let size = if array.bits { count.div_ceil(8) } else { count * kind.size() };
        let decoded = match self.packing {
            Some(packing) => Cow::Owned(self.unpacked(array, &encoded, packing, size, place)?),
            None => self.plain(array, &encoded, size, place)?,
        };
        if array.bits {
            return Ok(Values::from_bits(&decoded, count));
        }
        let layout = Layout { start: 0, stride: kind.size(), components: 1 };
        Ok(Values::gather(kind, &decoded, layout, count, self.order))
    }

    fn text(
        &self,
        array: &DataArray<'_>,
        kind: Kind,
        count: usize,
        start: usize,
        length: usize,
    ) -> Result<Values, ReadError> {
        let mut cursor = Cursor::starting(self.bytes.get(..start + length).unwrap_or_default(), start);
        let values = cursor.numbers(kind, count, &format!("array `{}`", array.name))?;
        match cursor.word() {
            None => Ok(values),
            Some(word) => {
                let message = format!("array `{}`: expected {}, found more", array.name, counted(count, "number"));
                Err(cursor.text_error_before(word, message))
            }
        }
    }

    fn appended(&self, array: &DataArray<'_>, offset: usize) -> Result<(Encoded<'a>, Option<Place>), ReadError> {
        let Some(Appended { base64, start }) = self.appended else {
            return Err(array_error(array, "expected an appended section, found none", None));
        };
        let at = start.saturating_add(offset);
        let place = Some(Place::Byte(at));
        let Some(rest) = self.bytes.get(at..) else {
            let message = format!("its offset {offset} is beyond the end of the file");
            return Err(array_error(array, &message, None));
        };
        if !base64 {
            return Ok((Encoded::Raw(rest), place));
        }
        let end = rest.iter().position(|&b| b == b'<').unwrap_or(rest.len());
        Ok((Encoded::Base64(&rest[..end]), place))
    }

    /// A count of bytes, then the bytes.
    fn plain<'e>(
        &mut self,
        array: &DataArray<'_>,
        encoded: &Encoded<'e>,
        size: usize,
        place: Option<Place>,
    ) -> Result<Cow<'e, [u8]>, ReadError> {
        let header = encoded.first(self.header_size, array, place)?;
        let said = self.word(&header, 0);
        if said != Some(size) {
            let said = said.map_or_else(|| "more than can be".to_owned(), |said| format!("{said} in its header"));
            return Err(size_error(array, size, &said, place));
        }
        let all = encoded.first(self.claim(array, size.saturating_add(self.header_size), place)?, array, place)?;
        Ok(match all {
            Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[self.header_size..]),
            Cow::Owned(bytes) => Cow::Owned(bytes[self.header_size..].to_vec()),
        })
    }

    /// The number of blocks, the size of each and of the last, the packed size of each; then the
    /// blocks.
    fn unpacked(
        &mut self,
        array: &DataArray<'_>,
        encoded: &Encoded<'_>,
        packing: Packing,
        size: usize,
        place: Option<Place>,
    ) -> Result<Vec<u8>, ReadError> {
        let too_large = || array_error(array, "its header has numbers that cannot be", place);
        let start = encoded.first(3 * self.header_size, array, place)?;
        let word = |index: usize| self.word(&start, index).ok_or_else(too_large);
        let (blocks, block_size, last_size) = (word(0)?, word(1)?, word(2)?);
        let last_size = if last_size == 0 { block_size } else { last_size };
        let before_last = blocks.saturating_sub(1).saturating_mul(block_size);
        let said = if blocks == 0 { 0 } else { before_last.saturating_add(last_size) };
        if said != size {
            return Err(size_error(array, size, &format!("{said} in its header"), place));
        }
        let header_size = blocks.saturating_add(3).saturating_mul(self.header_size);
        let header = encoded.first(header_size, array, place)?;
        let packed: Option<Vec<usize>> = (3..blocks + 3).map(|index| self.word(&header, index)).collect();
        let packed = packed.ok_or_else(too_large)?;
        let packed_size = packed.iter().fold(0, |sum: usize, &size| sum.saturating_add(size));
        if size > packed_size.saturating_mul(packing.most()) {
            let message = format!("{} cannot unpack to {size}", counted(packed_size, "byte"));
            return Err(array_error(array, &message, place));
        }
        let all = encoded.first(self.claim(array, header_size.saturating_add(packed_size), place)?, array, place)?;
        let mut rest = &all[header_size..];
        let mut out = Vec::with_capacity(size);
        for (index, packed_size) in packed.into_iter().enumerate() {
            let (block, after) = rest.split_at(packed_size);
            rest = after;
            let block_size = if index + 1 == blocks { last_size } else { block_size };
            packing
                .unpack(block, block_size, &mut out)
                .map_err(|message| array_error(array, &format!("block {} of {blocks}: {message}", index + 1), place))?;
        }
        Ok(out)
    }

    /// Takes `count` bytes from what arrays may still claim.
    fn claim(&mut self, array: &DataArray<'_>, count: usize, place: Option<Place>) -> Result<usize, ReadError> {
        match self.unclaimed.checked_sub(count) {
            Some(left) => {
                self.unclaimed = left;
                Ok(count)
            }
            None => {
                let message = format!("it and those before it claim {} more than the file has", count - self.unclaimed);
                Err(array_error(array, &message, place))
            }
        }
    }

    /// A count in a header.
    fn word(&self, header: &[u8], index: usize) -> Option<usize> {
        let bytes = header.get(index * self.header_size..(index + 1) * self.header_size)?;
        let append = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        let word = match self.order {
            Order::Big => bytes.iter().fold(0, append),
            Order::Little => bytes.iter().rev().fold(0, append),
        };
        usize::try_from(word).ok()
    }
}

impl Packing {
    /// Appends what a block unpacks to, which must be `size` bytes; that all blocks together can
    /// be so many was checked.
    fn unpack(self, block: &[u8], size: usize, out: &mut Vec<u8>) -> Result<(), String> {
        let before = out.len();
        let found = match self {
            Self::Zlib => {
                let mut decoder = ZlibDecoder::new(block).take(size as u64 + 1);
                decoder.read_to_end(out).map_err(|error| format!("the zlib data is damaged or cut off: {error}"))?
            }
            Self::Lz4 => {
                out.resize(before + size, 0);
                lz4_flex::block::decompress_into(block, &mut out[before..])
                    .map_err(|error| format!("the LZ4 data is damaged or cut off: {error}"))?
            }
        };
        if found == size { Ok(()) } else { Err(format!("expected {}, found {found}", counted(size, "byte"))) }
    }
}

impl<'a> Encoded<'a> {
    /// The first `count` bytes that are encoded.
    fn first(&self, count: usize, array: &DataArray<'_>, place: Option<Place>) -> Result<Cow<'a, [u8]>, ReadError> {
        match self {
            Self::Raw(bytes) => match bytes.get(..count) {
                Some(bytes) => Ok(Cow::Borrowed(bytes)),
                None => Err(size_error(array, count, &format!("{} before the end of the file", bytes.len()), place)),
            },
            Self::Base64(text) => {
                if count / 3 > text.len() / 4 {
                    let most = text.len() / 4 * 3;
                    return Err(size_error(array, count, &format!("at most {most} in its base64 text"), place));
                }
                let bytes = decode(text, count).map_err(|message| array_error(array, &message, place))?;
                match bytes.len() {
                    found if found < count => {
                        Err(size_error(array, count, &format!("{found} in its base64 text"), place))
                    }
                    _ => Ok(Cow::Owned(bytes)),
                }
            }
        }
    }
}

/// The first `count` bytes of a base64 text, or fewer if it has no more. A header may be encoded
/// by itself, so padding can stand in the middle.
fn decode(text: &[u8], count: usize) -> Result<Vec<u8>, String> {
    // Padding inside the text takes the place of at most two bytes.
    let characters = count.div_ceil(3) * 4 + 8;
    let text: Vec<u8> = text.iter().copied().filter(|b| !b.is_ascii_whitespace()).take(characters).collect();
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let mut rest = &text[..text.len() / 4 * 4];
    while !rest.is_empty() && out.len() < count {
        let padding = rest.iter().position(|&b| b == b'=');
        let end = padding.map_or(rest.len(), |at| (at / 4 + 1) * 4);
        let (group, after) = rest.split_at(end);
        STANDARD.decode_vec(group, &mut out).map_err(|error| format!("wrong base64: {error}"))?;
        rest = after;
    }
    out.truncate(count);
    Ok(out)
}
