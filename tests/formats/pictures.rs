//! Damaged pictures: whatever the bytes, the reader returns, and takes no more memory than they justify.

use std::io::Cursor;

use image::{DynamicImage, ImageBuffer, ImageEncoder, ImageFormat, Rgb, Rgba};
use meniscus::scene::image::{read, read_stored};

use super::fuzz;

fn written(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), format).unwrap();
    bytes
}

/// A small file of each form that the formats have, as far as a writer is at hand.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let light = |x: u32, y: u32| [x as f32 * 0.25, y as f32 * 3.0, (x * y) as f32];
    let float = DynamicImage::from(ImageBuffer::from_fn(9, 5, |x, y| Rgb(light(x, y))));
    let with_alpha = DynamicImage::from(ImageBuffer::from_fn(8, 3, |x, y| {
        let [r, g, b] = light(x, y);
        Rgba([r, g, b, 0.5])
    }));
    let wide = DynamicImage::from(ImageBuffer::from_pixel(20, 2, Rgb([0.5_f32, 0.25, 0.125])));
    let mut seeds: Vec<_> = [float.to_rgb8().into(), float.to_rgba8().into(), float.to_luma8().into()]
        .into_iter()
        .chain([float.to_rgb16().into(), float.to_luma_alpha8().into(), with_alpha.to_rgba16().into()])
        .map(|image: DynamicImage| ("a.png", written(&image, ImageFormat::Png)))
        .collect();
    seeds.push(("a.png", interlaced()));
    for image in [&float, &wide] {
        seeds.push(("a.hdr", written(image, ImageFormat::Hdr)));
        seeds.push(("a.exr", written(image, ImageFormat::OpenExr)));
    }
    seeds.push(("a.exr", written(&with_alpha, ImageFormat::OpenExr)));
    for (image, quality) in [(DynamicImage::from(float.to_rgb8()), 90), (float.to_luma8().into(), 30)] {
        let mut bytes = Vec::new();
        let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, quality);
        encoder.write_image(image.as_bytes(), 9, 5, image.color().into()).unwrap();
        seeds.push(("a.jpg", bytes));
    }
    seeds
}

/// A PNG of 2 x 2 in a palette of three, in Adam7's order.
fn interlaced() -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8; 4], data: &[u8]| {
        bytes.extend((data.len() as u32).to_be_bytes());
        bytes.extend(kind);
        bytes.extend(data);
        bytes.extend([0; 4]);
    };
    chunk(b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 2, 8, 3, 0, 0, 1]);
    chunk(b"PLTE", &[255, 0, 0, 0, 255, 0, 0, 0, 255]);
    chunk(b"tRNS", &[128]);
    let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, &[0, 0, 0, 1, 0, 2, 1]).unwrap();
    chunk(b"IDAT", &packed.finish().unwrap());
    chunk(b"IEND", &[]);
    mend_sums(&mut bytes);
    bytes
}

/// Gives a PNG's chunks the sums that they should have: with wrong ones nothing gets past the first.
fn mend_sums(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(&length) = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>()) {
        let end = at + 8 + u32::from_be_bytes(length) as usize;
        if end + 4 > bytes.len() {
            return;
        }
        let mut sum = flate2::Crc::new();
        sum.update(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&sum.sum().to_be_bytes());
        at = end + 4;
    }
}

/// Texels that a file of so many bytes may have.
fn justified(bytes: usize) -> usize {
    bytes * 8 * 1032 + (1 << 20)
}

fn check(name: &str, bytes: &[u8]) {
    let mut bytes = bytes.to_vec();
    if name == "a.png" {
        mend_sums(&mut bytes);
    }
    let whole = read(&bytes);
    // A decoder that trips is held back, but should not have come to it.
    assert!(!whole.as_ref().is_err_and(|error| error.message.ends_with("its reader failed")), "{whole:?}");
    if let Ok(image) = whole {
        assert_eq!(image.texels.len(), image.width as usize * image.height as usize);
        assert!(image.texels.len() <= justified(bytes.len()), "{} from {}", image.texels.len(), bytes.len());
        assert!(image.texels.as_flattened().iter().all(|x| x.is_finite()));
    }
    if let Ok(image) = read_stored(&bytes, 1 << 20) {
        assert_eq!(image.texels.len(), image.width as usize * image.height as usize);
        assert!(image.texels.len() <= justified(bytes.len()).min(1 << 20));
    }
}

#[test]
fn whole_seeds_are_read_and_cut_ones_never_panic() {
    for (name, seed) in seeds() {
        assert!(read(&seed).is_ok(), "{name} is no seed: {:?}", read(&seed));
        for end in 0..seed.len() {
            check(name, &seed[..end]);
        }
    }
}

#[test]
fn damaged_pictures_neither_panic_nor_take_memory() {
    fuzz::damaged(&seeds(), Vec::as_slice, (11, 400), |name, _, bytes| check(name, bytes));
}

/// `MENISCUS_FUZZ_SECONDS=600 cargo test --test formats pictures::fuzz -- --nocapture`.
#[test]
fn fuzz() {
    fuzz::fuzz(seeds(), Vec::as_slice, |name, _, bytes| check(name, bytes));
}

#[test]
fn what_decoders_trip_over_is_told() {
    let says = |bytes: &[u8]| read(bytes).unwrap_err().message;
    let mut palette = interlaced();
    // Ten bytes of colours, of which the last belongs to none.
    palette[36] = 10;
    palette.insert(50, 7);
    mend_sums(&mut palette);
    assert_eq!(says(&palette), "byte 33: a palette of 10 bytes is not one of whole colours");
    let mut tiles =
        written(&DynamicImage::from(ImageBuffer::from_pixel(20, 2, Rgb([0.5_f32; 3]))), ImageFormat::OpenExr);
    let at = tiles.windows(9).position(|part| part == b"tiledesc\0").unwrap() + 13;
    tiles[at..at + 8].copy_from_slice(&[0, 0x40, 0, 0, 0, 0x40, 0, 0]);
    let length = tiles.len();
    assert_eq!(
        says(&tiles),
        format!("the header says tiles of 16384 x 16384 pixels, which {length} bytes cannot hold")
    );
}
