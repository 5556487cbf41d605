//! Texels of every format that graphs may name, as bytes and as numbers. No GPU here.

use half::f16;
use wgpu_types::TextureFormat;

/// How the channels of a format lie in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channel {
    Unorm8,
    Snorm8,
    Srgb8,
    Uint8,
    Sint8,
    Unorm16,
    Uint16,
    Sint16,
    Float16,
    Uint32,
    Sint32,
    Float32,
}

/// (channel, how many, blue comes first), or nothing for packed formats.
fn layout(format: TextureFormat) -> Option<(Channel, usize, bool)> {
    use Channel as C;
    use TextureFormat as F;
    Some(match format {
        F::R8Unorm => (C::Unorm8, 1, false),
        F::Rg8Unorm => (C::Unorm8, 2, false),
        F::Rgba8Unorm => (C::Unorm8, 4, false),
        F::Bgra8Unorm => (C::Unorm8, 4, true),
        F::Rgba8UnormSrgb => (C::Srgb8, 4, false),
        F::Bgra8UnormSrgb => (C::Srgb8, 4, true),
        F::R8Snorm => (C::Snorm8, 1, false),
        F::Rg8Snorm => (C::Snorm8, 2, false),
        F::Rgba8Snorm => (C::Snorm8, 4, false),
        F::R8Uint | F::Stencil8 => (C::Uint8, 1, false),
        F::Rg8Uint => (C::Uint8, 2, false),
        F::Rgba8Uint => (C::Uint8, 4, false),
        F::R8Sint => (C::Sint8, 1, false),
        F::Rg8Sint => (C::Sint8, 2, false),
        F::Rgba8Sint => (C::Sint8, 4, false),
        F::R16Unorm | F::Depth16Unorm => (C::Unorm16, 1, false),
        F::R16Uint => (C::Uint16, 1, false),
        F::Rg16Uint => (C::Uint16, 2, false),
        F::Rgba16Uint => (C::Uint16, 4, false),
        F::R16Sint => (C::Sint16, 1, false),
        F::Rg16Sint => (C::Sint16, 2, false),
        F::Rgba16Sint => (C::Sint16, 4, false),
        F::R16Float => (C::Float16, 1, false),
        F::Rg16Float => (C::Float16, 2, false),
        F::Rgba16Float => (C::Float16, 4, false),
        F::R32Uint => (C::Uint32, 1, false),
        F::Rg32Uint => (C::Uint32, 2, false),
        F::Rgba32Uint => (C::Uint32, 4, false),
        F::R32Sint => (C::Sint32, 1, false),
        F::Rg32Sint => (C::Sint32, 2, false),
        F::Rgba32Sint => (C::Sint32, 4, false),
        // Depth of 24 bits is read back through a float target.
        F::R32Float | F::Depth32Float | F::Depth24Plus | F::Depth24PlusStencil8 | F::Depth32FloatStencil8 => {
            (C::Float32, 1, false)
        }
        F::Rg32Float => (C::Float32, 2, false),
        F::Rgba32Float => (C::Float32, 4, false),
        _ => return None,
    })
}

impl Channel {
    fn bytes(self) -> usize {
        match self {
            Channel::Unorm8 | Channel::Snorm8 | Channel::Srgb8 | Channel::Uint8 | Channel::Sint8 => 1,
            Channel::Unorm16 | Channel::Uint16 | Channel::Sint16 | Channel::Float16 => 2,
            Channel::Uint32 | Channel::Sint32 | Channel::Float32 => 4,
        }
    }

    fn read(self, b: &[u8]) -> f32 {
        let two = || [b[0], b[1]];
        let four = || [b[0], b[1], b[2], b[3]];
        match self {
            Channel::Unorm8 => f32::from(b[0]) / 255.0,
            Channel::Srgb8 => linear(f32::from(b[0]) / 255.0),
            Channel::Snorm8 => (f32::from(b[0] as i8) / 127.0).max(-1.0),
            Channel::Uint8 => f32::from(b[0]),
            Channel::Sint8 => f32::from(b[0] as i8),
            Channel::Unorm16 => f32::from(u16::from_le_bytes(two())) / 65535.0,
            Channel::Uint16 => f32::from(u16::from_le_bytes(two())),
            Channel::Sint16 => f32::from(i16::from_le_bytes(two())),
            Channel::Float16 => f16::from_le_bytes(two()).to_f32(),
            Channel::Uint32 => u32::from_le_bytes(four()) as f32,
            Channel::Sint32 => i32::from_le_bytes(four()) as f32,
            Channel::Float32 => f32::from_le_bytes(four()),
        }
    }

    fn write(self, v: f64, srgb: bool, out: &mut Vec<u8>) {
        match self {
            Channel::Srgb8 if srgb => out.push((encoded(v.clamp(0.0, 1.0)) * 255.0).round() as u8),
            Channel::Unorm8 | Channel::Srgb8 => out.push((v.clamp(0.0, 1.0) * 255.0).round() as u8),
            Channel::Snorm8 => out.push((v.clamp(-1.0, 1.0) * 127.0).round() as i8 as u8),
            Channel::Uint8 => out.push(v as u8),
            Channel::Sint8 => out.push(v as i8 as u8),
            Channel::Unorm16 => out.extend(((v.clamp(0.0, 1.0) * 65535.0).round() as u16).to_le_bytes()),
            Channel::Uint16 => out.extend((v as u16).to_le_bytes()),
            Channel::Sint16 => out.extend((v as i16).to_le_bytes()),
            Channel::Float16 => out.extend(f16::from_f64(v).to_le_bytes()),
            Channel::Uint32 => out.extend((v as u32).to_le_bytes()),
            Channel::Sint32 => out.extend((v as i32).to_le_bytes()),
            Channel::Float32 => out.extend((v as f32).to_le_bytes()),
        }
    }
}

/// Bytes of a texel as copies see it; of a depth format its depth, of 24-bit depth a float.
pub fn size(format: TextureFormat) -> Option<usize> {
    match format {
        TextureFormat::Rgb10a2Unorm | TextureFormat::Rg11b10Ufloat => Some(4),
        _ => layout(format).map(|(channel, count, _)| channel.bytes() * count),
    }
}

/// A texel as red, green, blue, alpha. What the format lacks is 0, alpha 1. Formats that store
/// sRGB come out linear.
pub fn decode(format: TextureFormat, texel: &[u8]) -> Option<[f32; 4]> {
    if texel.len() < size(format)? {
        return None;
    }
    let word = || u32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]]);
    match format {
        TextureFormat::Rgb10a2Unorm => {
            let w = word();
            let ten = |shift: u32| ((w >> shift) & 1023) as f32 / 1023.0;
            return Some([ten(0), ten(10), ten(20), (w >> 30) as f32 / 3.0]);
        }
        TextureFormat::Rg11b10Ufloat => {
            let w = word();
            return Some([small_float(w & 2047, 6), small_float((w >> 11) & 2047, 6), small_float(w >> 22, 5), 1.0]);
        }
        _ => {}
    }
    let (channel, count, blue_first) = layout(format)?;
    let mut color = [0.0, 0.0, 0.0, 1.0];
    for (i, bytes) in texel.chunks_exact(channel.bytes()).take(count).enumerate() {
        let kind = if channel == Channel::Srgb8 && i == 3 { Channel::Unorm8 } else { channel };
        color[i] = kind.read(bytes);
    }
    if blue_first {
        color.swap(0, 2);
    }
    Some(color)
}

/// A colour as a texel of the format; values outside its range are clamped.
pub fn encode(format: TextureFormat, color: [f64; 4]) -> Option<Vec<u8>> {
    let [r, g, b, a] = color;
    let ten = |v: f64| (v.clamp(0.0, 1.0) * 1023.0).round() as u32;
    match format {
        TextureFormat::Rgb10a2Unorm => {
            let w = ten(r) | ten(g) << 10 | ten(b) << 20 | ((a.clamp(0.0, 1.0) * 3.0).round() as u32) << 30;
            return Some(w.to_le_bytes().to_vec());
        }
        TextureFormat::Rg11b10Ufloat => {
            let w = to_small_float(r, 6) | to_small_float(g, 6) << 11 | to_small_float(b, 5) << 22;
            return Some(w.to_le_bytes().to_vec());
        }
        _ => {}
    }
    let (channel, count, blue_first) = layout(format)?;
    let order = if blue_first { [b, g, r, a] } else { color };
    let mut out = Vec::with_capacity(16);
    for (i, v) in order.into_iter().take(count).enumerate() {
        channel.write(v, i < 3, &mut out);
    }
    Some(out)
}

fn linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

fn encoded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// A float without sign, of 5 exponent bits and so many mantissa bits.
fn small_float(bits: u32, mantissa: u32) -> f32 {
    // Its bits are the upper ones of a half without the sign.
    f16::from_bits((bits << (10 - mantissa)) as u16).to_f32()
}

fn to_small_float(v: f64, mantissa: u32) -> u32 {
    let bits = u32::from(f16::from_f64(v.clamp(0.0, 65024.0)).to_bits());
    bits >> (10 - mantissa)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
    use super::*;
    use crate::format::NAMED;

    #[test]
    fn every_named_format_reads_back_what_was_written() {
        for (name, format) in NAMED {
            let bytes = encode(*format, [1.0, 0.0, 1.0, 1.0]).unwrap_or_else(|| panic!("{name} cannot be written"));
            assert_eq!(Some(bytes.len()), size(*format), "{name}");
            let back = decode(*format, &bytes).unwrap();
            assert_eq!(back[0], 1.0, "{name}");
            assert_eq!(back[1], 0.0, "{name}");
            assert_eq!(back[3], 1.0, "{name}");
            let channels = crate::format::channels(*format);
            assert_eq!(back[2], if channels > 2 { 1.0 } else { 0.0 }, "{name}");
        }
    }

    #[test]
    fn srgb_is_decoded_but_not_its_alpha() {
        let color = decode(TextureFormat::Rgba8UnormSrgb, &[188, 0, 0, 128]).unwrap();
        assert!((color[0] - 0.503).abs() < 0.002, "{color:?}");
        assert!((color[3] - 128.0 / 255.0).abs() < 1e-6, "{color:?}");
    }

    #[test]
    fn packed_floats_keep_their_value() {
        let bytes = encode(TextureFormat::Rg11b10Ufloat, [0.5, 3.0, 1024.0, 0.0]).unwrap();
        assert_eq!(decode(TextureFormat::Rg11b10Ufloat, &bytes).unwrap(), [0.5, 3.0, 1024.0, 1.0]);
    }
}
