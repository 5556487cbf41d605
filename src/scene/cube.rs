//! Six faces of a cube, or a cross of them in one picture, as an equirectangular picture, which is what
//! graphs take as an environment.
//!
//! Faces look along +x, -x, +y, -y, +z and -z and are seen from inside as graphics interfaces have them.

use std::num::NonZero;
use std::thread;

use glam::DVec3;
use half::f16;

use super::image::{Image, ImageError};

/// Of an equirectangular picture; larger faces are made smaller.
const WIDEST: u32 = 8192;

/// Where the faces of a cross lie, in squares from the top left corner; the last one of a cross that
/// stands is upside down.
const LYING: [[u32; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [3, 1]];
const STANDING: [[u32; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [1, 3]];

/// The six faces in a picture of 4 by 3 or 3 by 4 squares.
///
/// # Errors
/// If the picture has another shape.
pub fn faces_of_cross(cross: &Image) -> Result<[Image; 6], ImageError> {
    let (width, height) = (cross.width, cross.height);
    let (edge, places, turned) = match () {
        () if width % 4 == 0 && width / 4 * 3 == height => (width / 4, LYING, None),
        () if width % 3 == 0 && width / 3 * 4 == height => (width / 3, STANDING, Some(5)),
        () => {
            let message =
                format!("a cross of faces is 4 by 3 or 3 by 4 squares, and this is {width} x {height} pixels");
            return Err(ImageError {
                message,
                hint: Some("an equirectangular picture is given by its name alone".into()),
            });
        }
    };
    let row = |x: u32, y: u32| {
        let start = (y * width + x) as usize;
        cross.texels[start..start + edge as usize].iter().copied()
    };
    let mut at = 0;
    Ok(places.map(|[column, line]| {
        let mut texels: Vec<[f16; 4]> = (0..edge).flat_map(|y| row(column * edge, line * edge + y)).collect();
        if turned == Some(at) {
            texels.reverse();
        }
        at += 1;
        Image { width: edge, height: edge, texels, clipped: 0 }
    }))
}

/// The faces as one picture whose middle looks along -z and whose top is +y.
///
/// # Errors
/// If a face is not square, or not as large as the others.
pub fn equirect(faces: &[&Image; 6]) -> Result<Image, ImageError> {
    let edge = faces[0].width;
    for (face, name) in faces.iter().zip(["px", "nx", "py", "ny", "pz", "nz"]) {
        if face.width != edge || face.height != edge {
            let message = format!("face `{name}` is {} x {} pixels, and `px` {edge} wide", face.width, face.height);
            return Err(ImageError { message, hint: Some("the six faces of a cube are squares of one size".into()) });
        }
    }
    let width = edge.saturating_mul(4).min(WIDEST);
    let height = (width / 2).max(1);
    let mut texels = vec![[f16::ZERO; 4]; width as usize * height as usize];
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let part = (height as usize).div_ceil(threads) * width as usize;
    thread::scope(|scope| {
        for (index, texels) in texels.chunks_mut(part.max(1)).enumerate() {
            scope.spawn(move || {
                for (i, texel) in texels.iter_mut().enumerate() {
                    let i = index * part + i;
                    let (x, y) = (i % width as usize, i / width as usize);
                    *texel = sample(faces, direction(x, y, [width, height]));
                }
            });
        }
    });
    Ok(Image { width, height, texels, clipped: faces.iter().map(|face| face.clipped).sum() })
}

/// Where a texel of an equirectangular picture looks.
fn direction(x: usize, y: usize, [width, height]: [u32; 2]) -> DVec3 {
    let along = ((x as f64 + 0.5) / f64::from(width) - 0.5) * std::f64::consts::TAU;
    let down = (y as f64 + 0.5) / f64::from(height) * std::f64::consts::PI;
    DVec3::new(down.sin() * along.sin(), down.cos(), -down.sin() * along.cos())
}

/// Between the four nearest texels of the face that a direction meets.
fn sample(faces: &[&Image; 6], direction: DVec3) -> [f16; 4] {
    let (face, s, t) = meet(direction);
    let image = faces[face];
    let last = f64::from(image.width - 1);
    let place = |x: f64| ((0.5 + 0.5 * x) * f64::from(image.width) - 0.5).clamp(0.0, last);
    let (x, y) = (place(s), place(t));
    let texel = |x: f64, y: f64| image.texels[y as usize * image.width as usize + x as usize].map(f16::to_f64);
    let (left, top) = (x.floor(), y.floor());
    let (right, bottom) = ((left + 1.0).min(last), (top + 1.0).min(last));
    let (u, v) = (x - left, y - top);
    let corners = [texel(left, top), texel(right, top), texel(left, bottom), texel(right, bottom)];
    let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
    std::array::from_fn(|c| f16::from_f64(corners.iter().zip(weights).map(|(corner, w)| corner[c] * w).sum()))
}

/// The face that a direction meets, and where from -1 to 1: to the right and down.
fn meet(d: DVec3) -> (usize, f64, f64) {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        let face = usize::from(d.x < 0.0);
        (face, -d.z * d.x.signum() / a.x, -d.y / a.x)
    } else if a.y >= a.z {
        let face = 2 + usize::from(d.y < 0.0);
        (face, d.x / a.y, d.z * d.y.signum() / a.y)
    } else {
        let face = 4 + usize::from(d.z < 0.0);
        (face, d.x * d.z.signum() / a.z, -d.y / a.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A face in which each texel says where it looks, by the definition that shaders have.
    fn face(index: usize, edge: u32) -> Image {
        let towards = |x: u32, y: u32| {
            let (s, t) = (
                (f64::from(x) + 0.5) / f64::from(edge) * 2.0 - 1.0,
                (f64::from(y) + 0.5) / f64::from(edge) * 2.0 - 1.0,
            );
            match index {
                0 => DVec3::new(1.0, -t, -s),
                1 => DVec3::new(-1.0, -t, s),
                2 => DVec3::new(s, 1.0, t),
                3 => DVec3::new(s, -1.0, -t),
                4 => DVec3::new(s, -t, 1.0),
                _ => DVec3::new(-s, -t, -1.0),
            }
        };
        let texel = |x: u32, y: u32| {
            let d = towards(x, y).normalize();
            [d.x, d.y, d.z, 1.0].map(f16::from_f64)
        };
        let texels = (0..edge).flat_map(|y| (0..edge).map(move |x| texel(x, y))).collect();
        Image { width: edge, height: edge, texels, clipped: 0 }
    }

    fn looks_everywhere(picture: &Image) {
        for (i, texel) in picture.texels.iter().enumerate() {
            let (x, y) = (i % picture.width as usize, i / picture.width as usize);
            let wanted = direction(x, y, [picture.width, picture.height]);
            let found = DVec3::from_array([0, 1, 2].map(|c| texel[c].to_f64()));
            assert!(found.distance(wanted) < 0.05, "{x} {y}: {found} is not {wanted}");
        }
    }

    #[test]
    fn faces_become_a_picture_that_looks_the_same_way() {
        let faces: Vec<Image> = (0..6).map(|i| face(i, 32)).collect();
        let picture = equirect(&std::array::from_fn(|i| &faces[i])).expect("a picture");
        assert_eq!((picture.width, picture.height), (128, 64));
        looks_everywhere(&picture);
    }

    #[test]
    fn both_crosses_hold_the_same_faces() {
        let edge = 16;
        for (columns, lines, places) in [(4, 3, LYING), (3, 4, STANDING)] {
            let mut cross = Image { width: columns * edge, height: lines * edge, texels: Vec::new(), clipped: 0 };
            cross.texels = vec![[f16::NAN; 4]; (cross.width * cross.height) as usize];
            for (index, [column, line]) in places.into_iter().enumerate() {
                let mut face = face(index, edge);
                if (columns, index) == (3, 5) {
                    face.texels.reverse();
                }
                for (i, texel) in face.texels.into_iter().enumerate() {
                    let (x, y) = (i as u32 % edge + column * edge, i as u32 / edge + line * edge);
                    cross.texels[(y * cross.width + x) as usize] = texel;
                }
            }
            let faces = faces_of_cross(&cross).expect("a cross");
            looks_everywhere(&equirect(&std::array::from_fn(|i| &faces[i])).expect("a picture"));
        }
    }

    #[test]
    fn other_shapes_are_told() {
        let square = face(0, 4);
        assert!(faces_of_cross(&square).is_err_and(|e| e.message.contains("4 x 4 pixels")));
        let other = face(1, 8);
        let faces = [&square, &other, &square, &square, &square, &square];
        assert!(equirect(&faces).is_err_and(|e| e.message.starts_with("face `nx` is 8 x 8 pixels")));
    }
}
