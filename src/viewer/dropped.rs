//! What a file that was dropped can be opened as.

use std::io::Read as _;
use std::path::Path;

use super::state::short;
use crate::scene::{meshes, particles};
use crate::syntax::first_word;

/// What a file can be opened as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Scene,
    Graph,
    Particles,
    Mesh,
    Picture,
}

/// What a file is, by its name and, of RON, by its first word.
///
/// # Errors
/// If it is nothing that can be opened; the text says so.
pub fn kind_of(path: &Path) -> Result<Kind, String> {
    let shown = short(path);
    if path.is_dir() {
        return Err(format!("`{shown}` is a folder: drop a file of it"));
    }
    if path.extension().is_some_and(|end| end.eq_ignore_ascii_case("ron")) {
        let text = std::fs::read_to_string(path).map_err(|error| format!("`{shown}` cannot be read: {error}"))?;
        return Ok(if first_word(&text) == "Graph" { Kind::Graph } else { Kind::Scene });
    }
    // Some formats hold both: what has faces is a mesh.
    let is_mesh = meshes::known_extension(path);
    match particles::known_extension(path) {
        true if is_mesh && has_faces(path) => Ok(Kind::Mesh),
        true => Ok(Kind::Particles),
        false if is_mesh => Ok(Kind::Mesh),
        false if is_picture(path) => Ok(Kind::Picture),
        false => Err(format!("`{shown}` is no scene, graph, particle file, mesh or picture")),
    }
}

fn is_picture(path: &Path) -> bool {
    let end = path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase());
    end.is_some_and(|end| PICTURES.contains(&end.as_str()))
}

/// Ends of the names of pictures that an environment can be.
const PICTURES: &[&str] = &["png", "jpg", "jpeg", "hdr", "exr"];

/// Bytes that are looked at to tell particles from a mesh.
const LOOKED_AT: u64 = 256 << 20;

fn has_faces(path: &Path) -> bool {
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(LOOKED_AT).read_to_end(&mut bytes));
    read.is_ok() && meshes::has_faces(&bytes)
}
