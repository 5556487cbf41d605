//! Whether a file of a format that holds points or surfaces holds a surface.

/// Whether a `.ply` or legacy `.vtk` file says that it has faces; no value is read.
pub fn has_faces(bytes: &[u8]) -> bool {
    faces_of_ply(bytes) || faces_of_vtk(bytes)
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
