//! What a picture's header claims, looked at before a decoder takes memory for it or trips over it.

use ::image::ImageFormat;

/// Texels that one byte of a file can stand for: eight of one bit, packed as tightly as deflate does. A file that claims
/// more is not believed.
const MOST_TEXELS_A_BYTE: u64 = 8 * 1032;
/// The same where a texel has two bytes at least.
const MOST_WIDE_TEXELS_A_BYTE: u64 = 1032 / 2;
/// Texels that are believed of any file.
const FEW_TEXELS: u64 = 1 << 20;
const PNG_SIGNATURE: usize = 8;

/// Why a file cannot be what it claims to be.
pub(super) fn fault(bytes: &[u8], format: ImageFormat, [width, height]: [u32; 2], largest_side: u32) -> Option<String> {
    if width == 0 || height == 0 || width > largest_side || height > largest_side {
        return Some(format!("the header says {width} x {height} pixels; a picture has 1 to {largest_side} each way"));
    }
    if u64::from(width) * u64::from(height) > few_and(bytes, MOST_TEXELS_A_BYTE) {
        let length = bytes.len();
        return Some(format!("the header says {width} x {height} pixels, which {length} bytes cannot hold"));
    }
    match format {
        ImageFormat::Png => palette_fault(bytes),
        ImageFormat::OpenExr => tile_fault(bytes, largest_side),
        _ => None,
    }
}

fn few_and(bytes: &[u8], texels_a_byte: u64) -> u64 {
    (bytes.len() as u64).saturating_mul(texels_a_byte).saturating_add(FEW_TEXELS)
}

/// A palette is of whole colours: the decoder does not look (png 0.18).
fn palette_fault(bytes: &[u8]) -> Option<String> {
    let mut at = PNG_SIGNATURE;
    while let Some((length, kind)) =
        bytes.get(at..).and_then(|rest| rest.first_chunk::<8>()).map(|head| head.split_at(4))
    {
        let length = u32::from_be_bytes(length.try_into().ok()?) as usize;
        if kind == b"PLTE" && !length.is_multiple_of(3) {
            return Some(format!("byte {at}: a palette of {length} bytes is not one of whole colours"));
        }
        // The chunk's head, its data and its sum.
        at = at.checked_add(length)?.checked_add(12)?;
    }
    None
}

/// Tiles are no larger than what the file could hold: the decoder takes memory for one whatever its size (exr 1.74).
fn tile_fault(bytes: &[u8], largest_side: u32) -> Option<String> {
    const TILES: &[u8] = b"tiles\0tiledesc\0\x09\0\0\0";
    let mut rest = bytes;
    while let Some(at) = rest.windows(TILES.len()).position(|part| part == TILES) {
        rest = &rest[at + TILES.len()..];
        let (sides, _) = rest.first_chunk::<8>()?.as_chunks::<4>();
        let [width, height] = [u32::from_le_bytes(sides[0]), u32::from_le_bytes(sides[1])];
        let is_wrong = width.max(height) > largest_side
            || u64::from(width) * u64::from(height) > few_and(bytes, MOST_WIDE_TEXELS_A_BYTE);
        if is_wrong {
            let length = bytes.len();
            return Some(format!(
                "the header says tiles of {width} x {height} pixels, which {length} bytes cannot hold"
            ));
        }
    }
    None
}
