//! A picture that came out beside the one that a case expects.

use std::path::Path;

use super::read::{Case, Expected};
use crate::diagnostic::{Code, Diagnostic};
use crate::output::Output;

/// What is wrong with a picture. With `bless` it takes the place of the expected one instead.
pub fn compare(case: &Case, expected: &Expected, drawn: &[u8], bless: bool) -> Option<Diagnostic> {
    let path = &expected.path;
    let failed = |message: String| {
        let message = format!("{}: {message}", case.name.value);
        Diagnostic::error(Code::TEST_FAILED, message).at(expected.span, "expected so")
    };
    if bless {
        return write(path, drawn).err();
    }
    let bless_it = "`--bless` writes what comes out now; look at it before it is kept";
    let wanted = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return Some(failed(format!("there is no picture `{}` to compare with", path.display())).hint(bless_it));
        }
        Err(error) => return Some(failed(format!("cannot read `{}`: {error}", path.display()))),
    };
    let both = decoded(&wanted).and_then(|wanted| Ok((wanted, decoded(drawn)?)));
    let (wanted, drawn) = match both {
        Ok(both) => both,
        Err(why) => return Some(failed(format!("`{}` is no picture: {why}", path.display()))),
    };
    if wanted.dimensions() != drawn.dimensions() {
        let [(w, h), (x, y)] = [&wanted, &drawn].map(image::RgbImage::dimensions);
        return Some(failed(format!("the picture has {x} x {y} pixels, and `{}` {w} x {h}", path.display())));
    }
    let Difference { mean, most, at } = difference(&wanted, &drawn);
    (mean > expected.tolerance).then(|| {
        let (x, y) = at;
        let message = format!(
            "the picture differs from `{}` by {mean:.5} of white in the mean, and may by {}",
            path.display(),
            expected.tolerance
        );
        failed(message).hint(format!("most, by {most:.3}, at pixel {x}, {y}")).hint(bless_it)
    })
}

/// The folder is made where it is not there; the old picture stays if the new one cannot be written.
fn write(path: &Path, bytes: &[u8]) -> Result<(), Diagnostic> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        // What hinders it is told when the place is reserved.
        _ = std::fs::create_dir_all(folder);
    }
    Output::reserve(path)?.write(bytes)
}

fn decoded(bytes: &[u8]) -> Result<image::RgbImage, String> {
    let reader = image::ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format();
    let reader = reader.map_err(|error| error.to_string())?;
    reader.decode().map(|picture| picture.to_rgb8()).map_err(|error| error.to_string())
}

/// As parts of white.
struct Difference {
    /// Over all channels of all pixels.
    mean: f64,
    /// Of one channel, and where it is.
    most: f64,
    at: (u32, u32),
}

fn difference(a: &image::RgbImage, b: &image::RgbImage) -> Difference {
    let (mut sum, mut most, mut at) = (0_u64, 0, (0, 0));
    for ((x, y, a), b) in a.enumerate_pixels().zip(b.pixels()) {
        for (a, b) in a.0.iter().zip(b.0) {
            let apart = a.abs_diff(b);
            sum += u64::from(apart);
            if apart > most {
                (most, at) = (apart, (x, y));
            }
        }
    }
    let channels = (f64::from(a.width()) * f64::from(a.height()) * 3.0).max(1.0);
    Difference { mean: sum as f64 / 255.0 / channels, most: f64::from(most) / 255.0, at }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_difference_is_in_parts_of_white() {
        let black = image::RgbImage::new(4, 2);
        let mut other = black.clone();
        assert_eq!(difference(&black, &other).mean, 0.0);
        other.put_pixel(3, 1, image::Rgb([255, 0, 51]));
        let found = difference(&black, &other);
        assert!((found.mean - 1.2 / 24.0).abs() < 1e-12);
        assert_eq!((found.most, found.at), (1.0, (3, 1)));
    }
}
