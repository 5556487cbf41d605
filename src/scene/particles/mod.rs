//! Particle files: legacy and XML VTK, PLY, BGEO, XYZ, CSV, JSON, PDB and PTC.
//!
//! [`read`] turns the bytes of a file into a [`ParticleSet`]: named columns in the width that the
//! file has, of which `position` is always the first. A loader never trusts a header: each count
//! is checked against the bytes that are there before memory is taken for it, so that memory is
//! bounded by what the file holds, and what is wrong becomes a [`ReadError`] with its place.
//!
//! Cells and polygons are read over, but for `surface`, which mesh files ask for. Nothing else
//! that is not a value per point is tried here.

mod bgeo;
mod cursor;
mod error;
mod finish;
mod group;
mod json;
mod legacy_vtk;
mod lists;
mod parallel;
mod pdb;
mod ply;
mod polygons;
mod ptc;
mod radius;
mod stream;
mod table;
mod taken;
mod values;
mod xml_vtk;
mod xyz;

use std::borrow::Cow;
use std::path::Path;

pub use error::{Place, ReadError};
pub(super) use polygons::Polygons;
pub use radius::estimate_radius;
pub use taken::Taken;
pub use values::{Kind, Values};

/// One attribute of all particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// As the file has it, but for the position's.
    pub name: String,
    /// Numbers a row.
    pub components: usize,
    /// Row after row, `components` numbers each.
    pub values: Values,
}

impl Attribute {
    /// The values as `f32` lanes, `components` a row; see [`Values::to_f32`].
    pub fn to_f32(&self) -> Vec<f32> {
        self.values.to_f32()
    }

    /// The values as `u32` lanes, `components` a row; see [`Values::to_u32`].
    pub fn to_u32(&self) -> Vec<u32> {
        self.values.to_u32()
    }

    /// The values as `i32` lanes, `components` a row; see [`Values::to_i32`].
    pub fn to_i32(&self) -> Vec<i32> {
        self.values.to_i32()
    }
}

/// The particles of one file.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleSet {
    /// `position` (three numbers a row, `f32` or `f64` as in the file) always first.
    pub attributes: Vec<Attribute>,
    /// Rows that were kept.
    pub count: usize,
    /// Rows that were removed from all attributes since their position was not finite.
    pub dropped: usize,
    /// In metres, if the file gives one radius for all particles.
    pub radius: Option<f32>,
    /// Bounds of the positions that were kept, in metres; 0 if there are none.
    pub min: [f32; 3],
    /// See `min`.
    pub max: [f32; 3],
    /// What a person should know, a sentence each.
    pub notes: Vec<String>,
}

impl ParticleSet {
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }

    /// A set with the same attributes and no particles.
    pub fn emptied(&self) -> Self {
        let empty = |Attribute { name, components, values }: &Attribute| Attribute {
            name: name.clone(),
            components: *components,
            values: Values::empty(values.kind()),
        };
        Self {
            attributes: self.attributes.iter().map(empty).collect(),
            count: 0,
            dropped: 0,
            radius: self.radius,
            min: [0.0; 3],
            max: [0.0; 3],
            notes: Vec::new(),
        }
    }

    /// The positions in metres, as `f32`.
    pub fn positions(&self) -> Cow<'_, [[f32; 3]]> {
        self.attributes.first().map(|a| finish::triples(&a.values)).unwrap_or_default()
    }
}

/// The points of a file and the polygons between them.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// All rows of the file, finite or not, since polygons count them.
    pub positions: Vec<[f32; 3]>,
    pub attributes: Vec<Attribute>,
    pub polygons: Polygons,
}

type Reader = fn(&[u8]) -> Result<finish::Found, ReadError>;

/// Ends of file names and who reads such files.
const READERS: &[(&str, Reader)] = &[
    ("vtk", legacy_vtk::read),
    ("vtu", xml_vtk::read),
    ("vtp", xml_vtk::read),
    ("ply", ply::read),
    ("bgeo", bgeo::read),
    ("bgeo.gz", bgeo::read),
    ("xyz", xyz::read),
    ("csv", table::read),
    ("json", json::read),
    ("pdb", pdb::read),
    ("ptc", ptc::read),
];

fn reader_for(path: &Path) -> Option<Reader> {
    let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
    let ends = |end: &str| name.strip_suffix(end).is_some_and(|stem| stem.ends_with('.'));
    let reader = READERS.iter().find(|(end, _)| ends(end)).map(|(_, reader)| *reader);
    reader.or_else(|| lists::EXTENSIONS.iter().any(|end| ends(end)).then_some(lists::read as Reader))
}

/// The ends of the names of particle files, each with its dot.
pub fn extensions() -> impl Iterator<Item = String> {
    READERS.iter().map(|(end, _)| format!(".{end}"))
}

/// Whether [`read`] knows files of this name, if only to say which other file to name.
pub fn known_extension(path: &Path) -> bool {
    reader_for(path).is_some()
}

/// Reads the bytes of a particle file; `path` only tells the format.
///
/// A whole file without particles gives an empty set with a note.
///
/// # Errors
/// If the extension is unknown, or the bytes are not what they claim to be.
pub fn read(path: &Path, bytes: &[u8]) -> Result<ParticleSet, ReadError> {
    read_as(path, bytes, &Taken::default())
}

/// As [`read`], with attributes renamed and everything put where a scene has it.
///
/// # Errors
/// As [`read`], and if an attribute that gets another name is not there.
pub fn read_as(path: &Path, bytes: &[u8], taken: &Taken) -> Result<ParticleSet, ReadError> {
    let Some(reader) = reader_for(path) else {
        let known: Vec<String> = extensions().collect();
        let message = match path.extension() {
            Some(end) => format!("`.{}` is not the extension of a particle file", end.to_string_lossy()),
            None => "a particle file needs an extension that tells its format".to_owned(),
        };
        return Err(ReadError::new(message).hint(format!("known are {}", known.join(", "))));
    };
    if bytes.is_empty() {
        return Err(ReadError::new("the file is empty").at(Place::Byte(0)));
    }
    finish::finish(reader(bytes)?, taken)
}

/// Reads a file that may hold a surface, of the formats that have such: legacy VTK and PLY.
///
/// # Errors
/// As [`read`], and if a polygon has a corner that is no point.
pub(super) fn surface(path: &Path, bytes: &[u8]) -> Result<Surface, ReadError> {
    let is_ply = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("ply"));
    let (found, polygons) = if is_ply { ply::read_surface(bytes)? } else { legacy_vtk::read_surface(bytes)? };
    Ok(Surface { positions: finish::triples(&found.position).into_owned(), attributes: found.attributes, polygons })
}
