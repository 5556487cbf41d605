//! Pictures as textures: PNG, JPEG, Radiance HDR and OpenEXR become linear RGBA of 16-bit floats,
//! which every device can filter.

mod claims;

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use ::image::{DynamicImage, ImageFormat, ImageReader, Limits};
use half::f16;

/// Texels of a 2D texture, row by row from the top, `Rgba16Float`, linear, alpha not multiplied in.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<[f16; 4]>,
    /// Texels that were brighter than a 16-bit float can say, and now have its largest value.
    pub clipped: usize,
}

/// Texels of 8 bits each way as a file stores them, row by row from the top, alpha not multiplied
/// in. Whether they are sRGB or linear is known only to what uses them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stored {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<[u8; 4]>,
}

/// A file that is no picture, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageError {
    pub message: String,
    pub hint: Option<String>,
}

/// Width and height end here (WebGPU's default ends at 8,192, many devices at 16,384).
pub const LARGEST_SIDE: u32 = 16_384;
/// Bytes that decoding may take.
const LARGEST_MEMORY: u64 = 2 << 30;

const KNOWN: &[ImageFormat] = &[ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Hdr, ImageFormat::OpenExr];

/// Decodes a picture by its content. 8- and 16-bit files are taken as sRGB, HDR and EXR as linear.
///
/// # Errors
/// If the bytes are no picture of a known format, are cut short, or claim an impossible size.
pub fn read(bytes: &[u8]) -> Result<Image, ImageError> {
    decode(bytes, KNOWN, LARGEST_MEMORY).map(linear)
}

/// Decodes a picture with 8 bits a channel, as a material takes it: PNG or JPEG, of no more than
/// `most_texels`. Deeper channels keep their upper 8 bits.
///
/// # Errors
/// As [`read()`].
pub fn read_stored(bytes: &[u8], most_texels: usize) -> Result<Stored, ImageError> {
    let memory = (most_texels as u64).saturating_mul(4).min(LARGEST_MEMORY);
    let decoded = decode(bytes, &[ImageFormat::Png, ImageFormat::Jpeg], memory)?;
    let (width, height) = (decoded.width(), decoded.height());
    Ok(Stored { width, height, texels: decoded.into_rgba8().as_chunks::<4>().0.to_vec() })
}

fn decode(bytes: &[u8], known: &[ImageFormat], memory: u64) -> Result<DynamicImage, ImageError> {
    let fault = |message: String| ImageError { message, hint: None };
    if bytes.is_empty() {
        return Err(fault("the file is empty".into()));
    }
    let format = ::image::guess_format(bytes).ok().filter(|f| known.contains(f)).ok_or_else(|| ImageError {
        message: "byte 0: this is not the start of a picture that can be read".into(),
        hint: Some(match known.len() {
            2 => "known are PNG and JPEG".into(),
            _ => "known are PNG, JPEG, Radiance HDR (.hdr) and OpenEXR (.exr)".into(),
        }),
    })?;
    let dimensions = ImageReader::with_format(Cursor::new(bytes), format).into_dimensions();
    let (width, height) = dimensions.map_err(|e| fault(reason(&e, format)))?;
    if let Some(message) = claims::fault(bytes, format, [width, height], LARGEST_SIDE) {
        return Err(fault(message));
    }
    if u64::from(width) * u64::from(height) * 4 > memory {
        return Err(fault(format!("{width} x {height} pixels are more than there is room for")));
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(LARGEST_SIDE);
    limits.max_image_height = Some(LARGEST_SIDE);
    limits.max_alloc = Some(LARGEST_MEMORY);
    reader.limits(limits);
    // A decoder that trips over a file must not take a watch or a window along.
    match catch_unwind(AssertUnwindSafe(|| reader.decode())) {
        Ok(decoded) => decoded.map_err(|e| fault(reason(&e, format))),
        Err(_) => Err(fault(format!("this is no sound {} file: its reader failed", name_of(format)))),
    }
}

fn reason(error: &::image::ImageError, format: ImageFormat) -> String {
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default().trim_end_matches('.');
    format!("this is no whole {} file: {first}", name_of(format))
}

fn name_of(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Png => "PNG",
        ImageFormat::Jpeg => "JPEG",
        ImageFormat::Hdr => "Radiance HDR",
        _ => "OpenEXR",
    }
}

fn linear(decoded: DynamicImage) -> Image {
    let is_linear = matches!(decoded, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let (width, height) = (decoded.width(), decoded.height());
    let mut clipped = 0;
    let texels = if is_linear {
        let texel = |p: &[f32; 4]| {
            clipped += usize::from(p[..3].iter().any(|x| *x > f16::MAX.to_f32()));
            p.map(half_of)
        };
        decoded.into_rgba32f().as_chunks::<4>().0.iter().map(texel).collect()
    } else if matches!(decoded.color(), ::image::ColorType::Rgb8 | ::image::ColorType::Rgba8 | ::image::ColorType::L8) {
        let table: Vec<f16> = (0..=255u8).map(|x| f16::from_f64(decode_srgb(f64::from(x) / 255.0))).collect();
        let texel = |p: &[u8; 4]| {
            let [r, g, b, a] = *p;
            let color = [r, g, b].map(|x| table[usize::from(x)]);
            [color[0], color[1], color[2], f16::from_f32(f32::from(a) / 255.0)]
        };
        decoded.into_rgba8().as_chunks::<4>().0.iter().map(texel).collect()
    } else {
        let texel = |p: &[u16; 4]| {
            let [r, g, b, a] = p.map(|x| f64::from(x) / 65_535.0);
            let color = [r, g, b].map(|x| f16::from_f64(decode_srgb(x)));
            [color[0], color[1], color[2], f16::from_f64(a)]
        };
        decoded.into_rgba16().as_chunks::<4>().0.iter().map(texel).collect()
    };
    Image { width, height, texels, clipped }
}

/// The nearest finite 16-bit float; what is not a number becomes 0.
fn half_of(x: f32) -> f16 {
    let largest = f16::MAX.to_f32();
    if x.is_nan() { f16::ZERO } else { f16::from_f32(x.clamp(-largest, largest)) }
}

/// From a display value in 0 to 1 to light.
pub fn decode_srgb(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// From light in 0 to 1 to a display value.
pub fn encode_srgb(x: f64) -> f64 {
    if x <= 0.003_130_8 { x * 12.92 } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::image::{ImageEncoder, Rgb, Rgba};

    fn png(pixels: &[u8], width: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let height = pixels.len() as u32 / 4 / width;
        ::image::codecs::png::PngEncoder::new(&mut bytes)
            .write_image(pixels, width, height, ::image::ExtendedColorType::Rgba8)
            .expect("a PNG in memory");
        bytes
    }

    #[test]
    fn eight_bits_are_decoded_to_light() {
        let image = read(&png(&[0, 255, 128, 128], 1)).expect("a picture");
        let [r, g, b, a] = image.texels[0].map(f16::to_f32);
        assert_eq!((r, g), (0.0, 1.0));
        assert!((b - 0.2158).abs() < 2e-4 && (a - 0.502).abs() < 1e-3);
    }

    #[test]
    fn float_files_stay_linear_and_say_what_was_clipped() {
        let mut bytes = Vec::new();
        let mut buffer = ::image::ImageBuffer::<Rgba<f32>, _>::new(2, 1);
        buffer.put_pixel(0, 0, Rgba([0.5, 2.0, 1e6, 1.0]));
        buffer.put_pixel(1, 0, Rgba([0.25, f32::NAN, 3.0, 0.5]));
        DynamicImage::from(buffer).write_to(&mut Cursor::new(&mut bytes), ImageFormat::OpenExr).expect("an EXR");
        let image = read(&bytes).expect("a picture");
        assert_eq!(image.texels[0].map(f16::to_f32), [0.5, 2.0, 65504.0, 1.0]);
        assert_eq!(image.texels[1].map(f16::to_f32), [0.25, 0.0, 3.0, 0.5]);
        assert_eq!(image.clipped, 1);
    }

    #[test]
    fn each_known_format_is_told_by_its_content() {
        let image = DynamicImage::from(::image::ImageBuffer::from_pixel(4, 3, Rgb([0.5f32, 0.25, 0.125])));
        for format in KNOWN {
            let mut bytes = Vec::new();
            let source = match format {
                ImageFormat::Hdr | ImageFormat::OpenExr => image.clone(),
                _ => DynamicImage::from(image.to_rgb8()),
            };
            source.write_to(&mut Cursor::new(&mut bytes), *format).expect("written");
            let read = read(&bytes).expect("a picture");
            assert_eq!((read.width, read.height), (4, 3), "{format:?}");
        }
    }

    #[test]
    fn what_is_no_picture_is_an_error_with_a_reason() {
        let whole = png(&[7; 4 * 64 * 64], 64);
        let cut = read(&whole[..whole.len() / 2]).expect_err("cut short");
        assert!(cut.message.starts_with("this is no whole PNG file: "), "{}", cut.message);
        assert_eq!(read(&[]).map_err(|e| e.message), Err("the file is empty".into()));
        assert!(read(b"hello, world, this is text").is_err_and(|e| e.hint.is_some()));
    }

    #[test]
    fn a_header_that_promises_too_much_is_refused_before_memory_is_taken() {
        let mut bytes = png(&[7; 16], 2);
        // The width in the IHDR chunk, and the chunk's checksum.
        bytes[16..20].copy_from_slice(&60_000u32.to_be_bytes());
        let crc = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        let error = read(&bytes).expect_err("too wide");
        assert_eq!(error.message, "the header says 60000 x 2 pixels; a picture has 1 to 16384 each way");
        bytes[16..24].copy_from_slice(&[0, 0, 0x40, 0, 0, 0, 0x40, 0]);
        let crc = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        let message = format!("the header says 16384 x 16384 pixels, which {} bytes cannot hold", bytes.len());
        assert_eq!(read(&bytes).expect_err("too much").message, message);
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0u32, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { (c >> 1) ^ 0xEDB8_8320 } else { c >> 1 })
        })
    }
}
