//! Pictures as files: PNG for screens, OpenEXR for light.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use half::f16;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageBuffer, ImageEncoder as _, ImageFormat, Rgba};

use crate::scene::image::encode_srgb;
use crate::scene::sequence::Pattern;

/// Texels as four numbers each, linear.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    pub width: u32,
    /// Of all layers together, one below the other.
    pub height: u32,
    pub rgba: Vec<[f32; 4]>,
    /// Of the format that they came from: what it lacks is 0, alpha 1.
    pub channels: u32,
}

/// What a picture's file name asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureKind {
    /// 8 bits a channel, as a screen shows it.
    Png,
    /// 32-bit floats, linear, alpha multiplied in.
    Exr,
}

impl PictureKind {
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "png" => Some(Self::Png),
            "exr" => Some(Self::Exr),
            _ => None,
        }
    }
}

/// The display value in 0 to 255 of each 16-bit float from 0 to 1, by its bits.
fn display_table() -> Vec<u8> {
    (0..=f16::ONE.to_bits()).map(|bits| display(f16::from_bits(bits).to_f64())).collect()
}

fn display(light: f64) -> u8 {
    (encode_srgb(light.clamp(0.0, 1.0)) * 255.0).round() as u8
}

/// A presented picture (`Rgba16Float`, linear, 0 to 1, alpha multiplied in) as PNG; without
/// `transparent` alpha is left out.
///
/// # Errors
/// If the encoder refuses, which takes a size of nothing.
pub fn presented_png(size: [u32; 2], texels: &[u8], transparent: bool) -> Result<Vec<u8>, String> {
    let table = display_table();
    let shown = |x: f16| {
        let bits = if x > f16::ZERO { x.to_bits().min(f16::ONE.to_bits()) } else { 0 };
        table[usize::from(bits)]
    };
    let halves = texels.as_chunks::<8>().0;
    let rgba = |t: &[u8; 8]| {
        let (channels, _) = t.as_chunks::<2>();
        [channels[0], channels[1], channels[2], channels[3]].map(f16::from_le_bytes)
    };
    if transparent {
        let straight = |t: &[u8; 8]| straight(rgba(t).map(f16::to_f32));
        let pixels: Vec<u8> = halves.iter().flat_map(straight).collect();
        png(size, &pixels, ExtendedColorType::Rgba8)
    } else {
        let mut pixels = Vec::with_capacity(halves.len() * 3);
        for t in halves {
            let [r, g, b, _] = rgba(t);
            pixels.extend_from_slice(&[shown(r), shown(g), shown(b)]);
        }
        png(size, &pixels, ExtendedColorType::Rgb8)
    }
}

/// PNG wants alpha not multiplied in.
fn straight([r, g, b, a]: [f32; 4]) -> [u8; 4] {
    let a = f64::from(a).clamp(0.0, 1.0);
    let color = |x: f32| if a > 0.0 { display(f64::from(x) / a) } else { 0 };
    [color(r), color(g), color(b), (a * 255.0).round() as u8]
}

fn png(size: [u32; 2], pixels: &[u8], color: ExtendedColorType) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(pixels.len() / 2);
    // The default setting takes 40 times as long and saves a third of the bytes.
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Up)
        .write_image(pixels, size[0], size[1], color)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Any texture as PNG: values are taken as light, clamped to 0 to 1, and encoded for screens.
///
/// # Errors
/// If the encoder refuses, which takes a size of nothing.
pub fn texels_png(texels: &Texels) -> Result<Vec<u8>, String> {
    let shown = |x: f32| display(f64::from(x));
    let rgb = |p: &[f32; 4]| match texels.channels {
        1 => [p[0]; 3].map(shown),
        _ => [p[0], p[1], p[2]].map(shown),
    };
    let pixels: Vec<u8> = texels.rgba.iter().flat_map(rgb).collect();
    png([texels.width, texels.height], &pixels, ExtendedColorType::Rgb8)
}

/// OpenEXR, linear, as the numbers are.
///
/// # Errors
/// If the encoder refuses.
pub fn exr(texels: &Texels) -> Result<Vec<u8>, String> {
    let flat = texels.rgba.as_flattened().to_vec();
    let buffer = ImageBuffer::<Rgba<f32>, _>::from_raw(texels.width, texels.height, flat)
        .ok_or("there are too few texels for the picture's size")?;
    let mut bytes = Vec::new();
    buffer.write_to(&mut Cursor::new(&mut bytes), ImageFormat::OpenExr).map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// The name of the picture of a frame: the number in place of `{}` or a run of `#`, else before the
/// extension.
pub fn numbered(path: &Path, frame: u64) -> PathBuf {
    if let Some(pattern) = Pattern::of(path) {
        return pattern.path(frame);
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let number = format!("{frame:04}");
    let numbered = match name.split_once("{}") {
        Some((before, after)) => format!("{before}{number}{after}"),
        None => match name.rsplit_once('.') {
            Some((stem, end)) => format!("{stem}_{number}.{end}"),
            None => format!("{name}_{number}"),
        },
    };
    path.with_file_name(numbered)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn halves(values: &[[f32; 4]]) -> Vec<u8> {
        values.iter().flatten().flat_map(|x| f16::from_f32(*x).to_le_bytes()).collect()
    }

    fn decoded(bytes: &[u8]) -> image::DynamicImage {
        image::load_from_memory(bytes).expect("a picture")
    }

    #[test]
    fn light_is_encoded_for_screens() {
        let light = halves(&[[0.0, 0.2158, 1.0, 1.0], [-1.0, 7.0, f32::NAN, 0.0]]);
        let png = presented_png([2, 1], &light, false).expect("a PNG");
        assert_eq!(decoded(&png).into_rgb8().into_raw(), [0, 128, 255, 0, 255, 0]);
    }

    #[test]
    fn alpha_is_taken_out_of_the_color() {
        let light = halves(&[[0.25, 0.5, 0.0, 0.5], [0.0, 0.0, 0.0, 0.0]]);
        let png = presented_png([2, 1], &light, true).expect("a PNG");
        assert_eq!(decoded(&png).into_rgba8().into_raw(), [188, 255, 0, 128, 0, 0, 0, 0]);
    }

    #[test]
    fn exr_keeps_light_as_it_is() {
        let texels = Texels { width: 1, height: 1, rgba: vec![[0.25, 100.0, -1.0, 0.5]], channels: 4 };
        let back = decoded(&exr(&texels).expect("an EXR")).into_rgba32f().into_raw();
        assert_eq!(back, [0.25, 100.0, -1.0, 0.5]);
    }

    #[test]
    fn file_names_tell_the_kind() {
        assert_eq!(PictureKind::of(Path::new("a.b/c.PNG")), Some(PictureKind::Png));
        assert_eq!(PictureKind::of(Path::new("c.exr")), Some(PictureKind::Exr));
        assert_eq!(PictureKind::of(Path::new("c.jpg")), None);
        assert_eq!(PictureKind::of(Path::new("png")), None);
    }

    #[test]
    fn frames_are_numbered() {
        assert_eq!(numbered(Path::new("out/a.png"), 7), Path::new("out/a_0007.png"));
        assert_eq!(numbered(Path::new("out/{}-a.png"), 12345), Path::new("out/12345-a.png"));
        assert_eq!(numbered(Path::new("out/a_###.png"), 7), Path::new("out/a_007.png"));
    }
}
