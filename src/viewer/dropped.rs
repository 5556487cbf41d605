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
    read.is_ok() && (faces_of_ply(&bytes) || faces_of_vtk(&bytes))
}

/// Whether the header declares faces.
fn faces_of_ply(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    if lines.next() != Some(b"ply") {
        return false;
    }
    let header = lines.take_while(|line| *line != b"end_header");
    header.filter_map(|line| numbers(line, b"element face ")?.next()).any(|count| count > 0)
}

/// Whether there are polygons, or cells of three points and more.
fn faces_of_vtk(bytes: &[u8]) -> bool {
    let Some(version) = bytes.strip_prefix(b"# vtk DataFile Version ") else { return false };
    let is_new = version.first().is_some_and(|major| *major >= b'5');
    bytes.split(|byte| *byte == b'\n').any(|line| {
        let pair = |word| numbers(line, word).and_then(|mut found| Some((found.next()?, found.next()?)));
        let polygons = pair(b"POLYGONS ").is_some_and(|(count, size)| count > 0 && size > 1);
        // Numbers of points follow their count, or lie apart with one offset more than there are cells.
        let large = |(count, size): (u64, u64)| match is_new {
            true => count > 1 && size / (count - 1) >= 3,
            false => count > 0 && size / count >= 4,
        };
        polygons || pair(b"CELLS ").is_some_and(large)
    })
}

/// The numbers behind a word.
fn numbers<'a>(line: &'a [u8], word: &[u8]) -> Option<impl Iterator<Item = u64> + use<'a>> {
    let rest = line.strip_prefix(word).and_then(|rest| std::str::from_utf8(rest).ok())?;
    Some(rest.split_ascii_whitespace().map_while(|number| number.parse().ok()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_faces_is_a_mesh() {
        let points = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n";
        assert!(!faces_of_ply(points.as_bytes()));
        let surface =
            points.replace("end_header", "element face 7\nproperty list uchar int vertex_indices\nend_header");
        assert!(faces_of_ply(surface.as_bytes()));
        assert!(!faces_of_ply(surface.replace("face 7", "face 0").as_bytes()));
        let vtk = |version: &str, cells: &str| {
            let text =
                format!("# vtk DataFile Version {version}\na\nBINARY\nDATASET X\nPOINTS 9 float\n\u{1}\n{cells}\n");
            faces_of_vtk(text.as_bytes())
        };
        assert!(!vtk("4.2", "CELLS 9 18") && vtk("4.2", "CELLS 9 36"));
        assert!(!vtk("5.1", "CELLS 10 9") && vtk("5.1", "CELLS 10 27"));
        assert!(vtk("4.2", "POLYGONS 2 8") && !vtk("4.2", "POLYGONS 0 0") && !vtk("4.2", "VERTICES 9 18"));
    }
}
