//! What the device hands back, as numbers: texels of every format that graphs may name.

use half::f16;

use crate::format::TextureFormat as F;

/// Texels as four numbers each, missing channels 0 and missing alpha 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    pub width: u32,
    /// Of all layers together, one below the other.
    pub height: u32,
    pub rgba: Vec<[f32; 4]>,
    pub channels: u32,
    /// The numbers are encoded for screens already.
    pub is_srgb: bool,
}

/// Decodes tightly packed texels; `None` for formats without a decoder (depth with stencil).
pub fn decode(format: F, width: u32, height: u32, bytes: &[u8]) -> Option<Texels> {
    let channels = crate::format::channels(format);
    let (size, read) = channel(format)?;
    let swaps = format == F::Bgra8Unorm;
    let texel = |bytes: &[u8]| {
        let mut rgba = [0.0, 0.0, 0.0, 1.0];
        for (value, bytes) in rgba.iter_mut().zip(bytes.chunks_exact(size)) {
            *value = read(bytes);
        }
        if swaps {
            rgba.swap(0, 2);
        }
        rgba
    };
    let packed: Option<fn(u32) -> [f32; 4]> = match format {
        F::Rgb10a2Unorm => Some(|w| {
            [w & 1023, w >> 10 & 1023, w >> 20 & 1023, (w >> 30) * 341].map(|x| x as f32 / 1023.0)
        }),
        F::Rg11b10Ufloat => Some(|w| [small_float(w & 2047, 6), small_float(w >> 11 & 2047, 6), small_float(w >> 22, 5), 1.0]),
        _ => None,
    };
    let rgba: Vec<[f32; 4]> = match packed {
        Some(unpack) => bytes.as_chunks::<4>().0.iter().map(|b| unpack(u32::from_le_bytes(*b))).collect(),
        None => bytes.chunks_exact(size * channels as usize).map(texel).collect(),
    };
    let is_whole = rgba.len() as u64 == u64::from(width) * u64::from(height);
    is_whole.then_some(Texels { width, height, rgba, channels, is_srgb: format == F::Rgba8UnormSrgb })
}

type Read = fn(&[u8]) -> f32;

/// Bytes of a channel and how to read it.
fn channel(format: F) -> Option<(usize, Read)> {
    Some(match format {
        F::R8Unorm | F::Rg8Unorm | F::Rgba8Unorm | F::Rgba8UnormSrgb | F::Bgra8Unorm => (1, |b| f32::from(b[0]) / 255.0),
        F::R8Snorm | F::Rgba8Snorm => (1, |b| (f32::from(b[0] as i8) / 127.0).max(-1.0)),
        F::R8Uint | F::Rg8Uint | F::Rgba8Uint | F::Stencil8 => (1, |b| f32::from(b[0])),
        F::R8Sint | F::Rgba8Sint => (1, |b| f32::from(b[0] as i8)),
        F::R16Uint | F::Rg16Uint | F::Rgba16Uint => (2, |b| f32::from(u16::from_le_bytes([b[0], b[1]]))),
        F::R16Sint | F::Rgba16Sint => (2, |b| f32::from(i16::from_le_bytes([b[0], b[1]]))),
        F::Depth16Unorm => (2, |b| f32::from(u16::from_le_bytes([b[0], b[1]])) / 65_535.0),
        F::R16Float | F::Rg16Float | F::Rgba16Float => (2, |b| f16::from_le_bytes([b[0], b[1]]).to_f32()),
        F::R32Uint | F::Rg32Uint | F::Rgba32Uint => (4, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32),
        F::R32Sint | F::Rgba32Sint => (4, |b| i32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32),
        F::R32Float | F::Rg32Float | F::Rgba32Float | F::Depth32Float => {
            (4, |b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        }
        F::Rgb10a2Unorm | F::Rg11b10Ufloat => (1, |_| 0.0),
        _ => return None,
    })
}

/// A float without sign, with 5 bits of exponent and `mantissa` bits behind.
fn small_float(bits: u32, mantissa: u32) -> f32 {
    // The layout is a 16-bit float's, without the sign and the last bits.
    f16::from_bits((bits << (10 - mantissa)) as u16).to_f32()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_named_format_but_depth_with_stencil_decodes() {
        for (name, format) in crate::format::NAMED {
            let size = format.block_copy_size(None).unwrap_or(4) as usize;
            let found = decode(*format, 2, 1, &vec![0; 2 * size]);
            let expected = !matches!(format, F::Depth24Plus | F::Depth24PlusStencil8 | F::Depth32FloatStencil8);
            assert_eq!(found.is_some(), expected, "{name}");
            let black = |t: &Texels| t.rgba.iter().all(|p| p[..3] == [0.0; 3]);
            assert!(found.is_none_or(|t| black(&t)), "{name}");
        }
    }

    #[test]
    fn numbers_come_back_as_they_went_in() {
        let first = |format, bytes: &[u8]| decode(format, 1, 1, bytes).map(|t| t.rgba[0]);
        let halves: Vec<u8> = [0.5, -2.0, 8.0, 0.25].iter().flat_map(|x| f16::from_f32(*x).to_le_bytes()).collect();
        assert_eq!(first(F::Rgba16Float, &halves), Some([0.5, -2.0, 8.0, 0.25]));
        assert_eq!(first(F::R32Float, &1.5f32.to_le_bytes()), Some([1.5, 0.0, 0.0, 1.0]));
        assert_eq!(first(F::Bgra8Unorm, &[255, 0, 51, 255]), Some([0.2, 0.0, 1.0, 1.0]));
        assert_eq!(first(F::R8Sint, &[254]), Some([-2.0, 0.0, 0.0, 1.0]));
        assert_eq!(first(F::Rgb10a2Unorm, &(1023u32 | 3 << 30).to_le_bytes()), Some([1.0, 0.0, 0.0, 1.0]));
        let ones = 0x3C0 | 0x3C0 << 11 | 0x1E0 << 22;
        assert_eq!(first(F::Rg11b10Ufloat, &u32::to_le_bytes(ones)), Some([1.0; 4]));
    }

    #[test]
    fn too_few_bytes_are_no_picture() {
        assert_eq!(decode(F::Rgba8Unorm, 2, 2, &[0; 12]), None);
    }
}
