//! Surfaces in the files of simulators: legacy VTK and PLY.

use meniscus::files::MemoryFiles;
use meniscus::scene::meshes::Primitive;

use super::{read, said, whole};

fn first(name: &str, content: impl AsRef<[u8]>) -> Primitive {
    whole(&MemoryFiles::default().with(name, content), name).meshes[0].primitives[0].clone()
}

fn corners(primitive: &Primitive) -> Vec<[f32; 3]> {
    primitive.indices.iter().map(|index| primitive.positions[*index as usize]).collect()
}

/// Five points: a square and one that nothing uses before it.
const POINTS: &str = "9 9 9\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
/// The square's corners by their points.
const SQUARE: [[f32; 3]; 6] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

pub fn vtk(dataset: &str, cells: &str) -> String {
    format!("# vtk DataFile Version 5.1\nt\nASCII\nDATASET {dataset}\nPOINTS 5 float\n{POINTS}{cells}")
}

#[test]
fn cells_of_vtk_in_all_their_forms() {
    let grid = "UNSTRUCTURED_GRID";
    let files = [
        vtk("POLYDATA", "POLYGONS 1 5\n4 1 2 3 4\n"),
        vtk("POLYDATA", "POLYGONS 2 8\n3 1 2 3\n3 1 3 4\n"),
        vtk("POLYDATA", "POLYGONS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n1 2 3 4\n"),
        vtk(grid, "CELLS 1 5\n4 1 2 3 4\nCELL_TYPES 1\n9\n"),
        vtk(grid, "CELLS 2 8\n3 1 2 3\n3 1 3 4\nCELL_TYPES 2\n5\n7\n"),
        vtk(grid, "CELLS 1 5\n4 1 2 4 3\nCELL_TYPES 1\n8\n"),
        vtk(
            grid,
            "CELLS 3 6\nOFFSETS vtktypeint32\n0 3 6\nCONNECTIVITY vtktypeint32\n1 2 3 1 3 4\nCELL_TYPES 2\n5\n5\n",
        ),
    ];
    for file in files {
        let primitive = first("a.vtk", &file);
        assert_eq!(corners(&primitive), SQUARE, "{file}");
        assert_eq!(primitive.normals, [[0.0, 0.0, 1.0]; 4], "{file}");
    }
    let strip = first("a.vtk", vtk("POLYDATA", "TRIANGLE_STRIPS 1 5\n4 1 2 4 3\n"));
    assert!(strip.normals.iter().all(|normal| *normal == [0.0, 0.0, 1.0]));
    assert_eq!(strip.indices.len(), 6);
}

#[test]
fn binary_vtk_with_normals_and_coordinates() {
    let mut file = b"# vtk DataFile Version 4.2\nt\nBINARY\nDATASET POLYDATA\nPOINTS 3 double\n".to_vec();
    [0.0f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().for_each(|x| file.extend(x.to_be_bytes()));
    file.extend(b"\nPOLYGONS 1 4\n");
    [3i32, 0, 1, 2].iter().for_each(|x| file.extend(x.to_be_bytes()));
    file.extend(b"\nPOINT_DATA 3\nNORMALS Normals float\n");
    [0.0f32, 0.6, 0.8].repeat(3).iter().for_each(|x| file.extend(x.to_be_bytes()));
    file.extend(b"\nTEXTURE_COORDINATES TCoords 2 float\n");
    [0.25f32, 0.5].repeat(3).iter().for_each(|x| file.extend(x.to_be_bytes()));
    let primitive = first("a.vtk", &file);
    assert_eq!(primitive.normals, [[0.0, 0.6, 0.8]; 3]);
    assert_eq!(primitive.uv0, [[0.25, 0.5]; 3]);
}

pub fn ply(format: &str, more: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n{more}"
    )
}

#[test]
fn faces_of_ply_as_text_and_in_both_orders() {
    let header = "element face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\nend_header\n";
    let rows: Vec<[f32; 3]> = POINTS
        .lines()
        .map(|line| {
            let numbers: Vec<f32> = line.split(' ').map(|word| word.parse().unwrap()).collect();
            [numbers[0], numbers[1], numbers[2]]
        })
        .collect();
    let mut files = vec![ply("ascii", header).into_bytes()];
    rows.iter().for_each(|[x, y, z]| files[0].extend(format!("{x} {y} {z} 255 188 0\n").bytes()));
    files[0].extend(b"7 4 1 2 3 4\n0 2 1 2\n");
    for is_big in [false, true] {
        let mut file = ply(if is_big { "binary_big_endian" } else { "binary_little_endian" }, header).into_bytes();
        let four = |bits: u32| if is_big { bits.to_be_bytes() } else { bits.to_le_bytes() };
        for row in &rows {
            row.iter().for_each(|x| file.extend(four(x.to_bits())));
            file.extend([255, 188, 0]);
        }
        for face in [&[1_u32, 2, 3, 4][..], &[1, 2]] {
            file.extend([0, face.len() as u8]);
            face.iter().for_each(|index| file.extend(four(*index)));
        }
        files.push(file);
    }
    for file in files {
        let model = read(&MemoryFiles::default().with("a.ply", &file), "a.ply").unwrap();
        let expected = "warning: left out, having less than three corners: 1 polygon\n";
        assert_eq!(said(&model.diagnostics, "a.ply"), expected);
        let primitive = &model.meshes[0].primitives[0];
        assert_eq!(corners(primitive), SQUARE);
        let [r, g, b, a] = primitive.color0[0];
        assert!((r, b, a) == (1.0, 0.0, 1.0) && (g - 0.5028).abs() < 1e-3, "{:?}", primitive.color0);
    }
}
