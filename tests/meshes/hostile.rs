//! Damaged files: whatever the bytes, a reader returns, and takes no more memory than they
//! justify.

use std::path::Path;
use std::sync::Arc;

use meniscus::files::MemoryFiles;
use meniscus::scene::meshes::{self, Model};
use serde_json::json;

use super::build::{Builder, F32, U8, U16, bytes, png};
use super::fuzz::{self, peak};
use super::surface::{ply, vtk};

/// A glTF with something of everything.
fn rich() -> Builder {
    let mut b = Builder::new();
    let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let position = b.attribute("POSITION", "VEC3", F32, &square);
    b.attribute("NORMAL", "VEC3", F32, &[0.0, 0.0, 1.0].repeat(4));
    b.attribute("TANGENT", "VEC4", F32, &[1.0, 0.0, 0.0, 1.0].repeat(4));
    b.attribute("TEXCOORD_0", "VEC2", U8, &[0.0, 255.0, 255.0, 255.0, 255.0, 0.0, 0.0, 0.0]);
    b.attribute("COLOR_0", "VEC4", U8, &[255.0; 16]);
    b.indices(U16, &[0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
    let places = b.view(&bytes(U8, &[1.0, 3.0]));
    let values = b.view(&bytes(F32, &[1.0; 6]));
    b.document["accessors"][position]["sparse"] = json!({"count": 2,
        "indices": {"bufferView": places, "componentType": U8}, "values": {"bufferView": values}});
    b.primitive()["material"] = json!(0);
    let strip = json!({"attributes": {"POSITION": position, "TEXCOORD_0": 3}, "mode": 5, "material": 0});
    b.document["meshes"][0]["primitives"].as_array_mut().unwrap().push(strip);
    let picture = b.view(&png(&[[1, 2, 3, 4]; 3]));
    b.push("images", json!({"bufferView": picture, "mimeType": "image/png"}));
    b.push("samplers", json!({"magFilter": 9728, "minFilter": 9987, "wrapS": 33071}));
    b.push("textures", json!({"source": 0, "sampler": 0}));
    b.push(
        "materials",
        json!({"name": "m", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.5, 1], "metallicFactor": 0.5,
                "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2]}}}},
               "normalTexture": {"index": 0, "scale": 0.5}, "alphaMode": "MASK", "alphaCutoff": 0.5}),
    );
    b.document["nodes"] = json!([{"children": [1, 2], "rotation": [0, 0.6, 0, 0.8]},
        {"mesh": 0, "scale": [1, 2, 3]}, {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]}]);
    let input = b.accessor("SCALAR", F32, &[0.0, 1.0, 2.0]);
    let moved = b.accessor("VEC3", F32, &[0.0; 27]);
    let turned = b.accessor("VEC4", F32, &[0.0, 0.0, 0.0, 1.0].repeat(3));
    b.push(
        "animations",
        json!({"channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}},
                            {"sampler": 1, "target": {"node": 0, "path": "rotation"}}],
               "samplers": [{"input": input, "output": moved, "interpolation": "CUBICSPLINE"},
                            {"input": input, "output": turned}]}),
    );
    b
}

/// Many nodes that share a mesh of many primitives that share their vertices.
fn crowd() -> Vec<u8> {
    let mut builder = Builder::triangle();
    builder.document["scenes"][0]["nodes"] = (0..30).collect();
    builder.document["nodes"] = (0..30).map(|_| json!({"mesh": 0})).collect();
    builder.document["meshes"][0]["primitives"] = (0..30).map(|_| json!({"attributes": {"POSITION": 0}})).collect();
    builder.glb()
}

/// Small files of each form, with the files that they name.
fn seeds() -> Vec<(&'static str, Vec<u8>, MemoryFiles)> {
    let rich = rich();
    let files = rich.files();
    let document = files.0[Path::new("a.gltf")].to_vec();
    let compact = serde_json::to_vec(&rich.document).unwrap();
    let base64 = base64::Engine::encode(&base64::prelude::BASE64_STANDARD, &rich.binary);
    let mut embedded = rich.document.clone();
    embedded["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{base64}"));
    let obj = "mtllib a.mtl\no thing\nv 0 0 0 1 1 1\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n\
               usemtl red\ns 1\nf 1/1/1 2/2/1 3/3/1 4/1/1\nf 1 2 5\nf 2 3 -1\ns off\nusemtl blue\nf 3/1 4/2 5/3\nf 1 2 3 4 5 1\n";
    let mtl = "newmtl red\nKd 1 0 0\nNs 10\nd 0.5\nmap_Kd -s 2 2 -o 0.5 0 a.png\nmap_Bump -bm 0.5 b.png\n\
               newmtl blue\nKe 0 0 2\nPr 0.5\nPm 1\nmap_d a.png\nmap_Pr a.png\nmap_Pm b.png\nTr 0.25\n";
    let pictures = MemoryFiles::default().with("a.png", png(&[[9; 4]; 2])).with("b.png", png(&[[1, 2, 3, 4]; 2]));
    let with_mtl = pictures.clone().with("a.mtl", mtl);
    vec![
        ("a.gltf", document, files.clone()),
        ("a.gltf", compact, files),
        ("a.gltf", serde_json::to_vec(&embedded).unwrap(), MemoryFiles::default()),
        ("a.glb", rich.glb(), MemoryFiles::default()),
        ("a.glb", crowd(), MemoryFiles::default()),
        ("a.obj", obj.as_bytes().to_vec(), with_mtl),
        ("a.mtl", mtl.as_bytes().to_vec(), pictures.with("a.obj", obj)),
        ("a.vtk", grid(true), MemoryFiles::default()),
        ("a.vtk", grid(false), MemoryFiles::default()),
        ("a.vtk", five(), MemoryFiles::default()),
        ("a.ply", faces(None), MemoryFiles::default()),
        ("a.ply", faces(Some(false)), MemoryFiles::default()),
        ("a.ply", faces(Some(true)), MemoryFiles::default()),
        ("data.bin", rich.binary.clone(), rich.files()),
    ]
}

/// Cells of legacy VTK, as text in the form of version 5 and as binary in that of version 4.
fn grid(is_text: bool) -> Vec<u8> {
    if is_text {
        let cells =
            "CELLS 3 6\nOFFSETS vtktypeint64\n0 3 6\nCONNECTIVITY vtktypeint64\n1 2 3 1 3 4\nCELL_TYPES 2\n5\n7\n";
        return vtk("UNSTRUCTURED_GRID", &format!("{cells}POINT_DATA 5\nNORMALS n float\n{}", "0 0 1\n".repeat(5)))
            .into_bytes();
    }
    let mut file = b"# vtk DataFile Version 4.2\nt\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n".to_vec();
    [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0].iter().for_each(|x| file.extend(x.to_be_bytes()));
    file.extend(b"\nPOLYGONS 2 9\n");
    [4, 0, 1, 2, 3, 3, 0, 2, 3].iter().for_each(|x: &i32| file.extend(x.to_be_bytes()));
    file.extend(b"\nTRIANGLE_STRIPS 1 5\n");
    [4, 0, 1, 2, 3].iter().for_each(|x: &i32| file.extend(x.to_be_bytes()));
    file
}

/// Polygons of legacy VTK 5.1, as binary.
fn five() -> Vec<u8> {
    let mut file = b"# vtk DataFile Version 5.1\nt\nBINARY\nDATASET POLYDATA\nPOINTS 3 double\n".to_vec();
    [0.0f64, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0].iter().for_each(|x| file.extend(x.to_be_bytes()));
    file.extend(b"\nPOLYGONS 3 6\nOFFSETS vtktypeint64\n");
    [0, 3, 6].iter().for_each(|x: &i64| file.extend(x.to_be_bytes()));
    file.extend(b"\nCONNECTIVITY vtktypeint64\n");
    [0, 1, 2, 2, 1, 0].iter().for_each(|x: &i64| file.extend(x.to_be_bytes()));
    file.extend(b"\nPOINT_DATA 3\nTEXTURE_COORDINATES t 2 float\n");
    [0.0f32; 6].iter().for_each(|x| file.extend(x.to_be_bytes()));
    file
}

/// Faces of PLY: as text, or binary with either end of a number first.
fn faces(is_big: Option<bool>) -> Vec<u8> {
    let more = "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
    let Some(is_big) = is_big else {
        let rows = "0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n5 5 5 1 2 3\n";
        return format!("{}{rows}4 0 1 2 3\n3 0 1 4\n", ply("ascii", more)).into_bytes();
    };
    let word = |bits: u32| if is_big { bits.to_be_bytes() } else { bits.to_le_bytes() };
    let mut file = ply(if is_big { "binary_big_endian" } else { "binary_little_endian" }, more).into_bytes();
    for row in 0..5_u8 {
        [f32::from(row), f32::from(row * row), 1.0].iter().for_each(|x| file.extend(word(x.to_bits())));
        file.extend([1, 2, 3]);
    }
    for face in [&[0, 1, 2, 3][..], &[0, 1, 4]] {
        file.push(face.len() as u8);
        face.iter().for_each(|index: &u32| file.extend(word(*index)));
    }
    file
}

/// Bytes of all that was made.
fn size(model: &Model) -> usize {
    let primitives = model.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let triangles: usize = primitives.map(|p| p.positions.len() * 72 + p.indices.len() * 4).sum();
    triangles + model.images.iter().map(|image| image.texels.len() * 4).sum::<usize>()
}

/// Bytes of what whoever draws a model keeps for it: a call, a place and a matrix for each primitive of each node.
fn drawn(model: &Model) -> usize {
    let shown = model.nodes.iter().filter_map(|node| model.meshes.get(node.mesh?));
    shown.map(|mesh| mesh.primitives.len()).sum::<usize>() * 256
}

/// Everything that a reader promises of a model.
fn check(name: &str, model: &Model, justified: usize) {
    let made = size(model) + drawn(model);
    assert!(made <= justified, "{name}: {made} bytes from {justified}");
    for primitive in model.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        let count = primitive.positions.len();
        let counts = [primitive.normals.len(), primitive.tangents.len(), primitive.uv0.len(), primitive.uv1.len()];
        assert_eq!(counts, [count; 4], "{name}");
        assert_eq!((primitive.color0.len(), primitive.indices.len() % 3), (count, 0), "{name}");
        assert!(primitive.indices.iter().all(|index| (*index as usize) < count), "{name}");
        assert!(primitive.material < model.materials.len(), "{name}");
        assert!(primitive.positions.as_flattened().iter().all(|x| x.is_finite()), "{name}");
        let is_unit = |v: &[f32]| (v.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-3;
        assert!(primitive.normals.iter().all(|n| is_unit(n)), "{name}");
        assert!(primitive.tangents.iter().all(|t| is_unit(&t[..3]) && t[3].abs() == 1.0), "{name}");
    }
    for (index, node) in model.nodes.iter().enumerate() {
        assert!(node.parent.is_none_or(|parent| parent < index), "{name}");
        assert!(node.mesh.is_none_or(|mesh| mesh < model.meshes.len()), "{name}");
    }
    for texture in model.materials.iter().filter_map(|m| m.base_color_texture) {
        assert!(texture.image < model.images.len() && texture.uv_set < 2, "{name}");
    }
    for animation in 0..=model.animations.len() {
        assert_eq!(model.turning(Some(animation)).len(), model.nodes.len(), "{name}");
        for time in [f64::NAN, -1.0, 0.0, 0.5, 1.0, 1e30] {
            assert_eq!(model.pose(Some(animation), time).len(), model.nodes.len(), "{name}");
        }
    }
}

/// The file that one reads to come to a file.
fn entry(name: &str) -> &str {
    match name {
        "a.mtl" => "a.obj",
        "data.bin" => "a.gltf",
        other => other,
    }
}

fn attempt(name: &str, bytes: Vec<u8>, files: &MemoryFiles) {
    let files = files.clone().with(name, &bytes);
    let path = Path::new(entry(name));
    let bundle = meshes::gather(&files, path, files.0[path].clone());
    let all: usize = files.0.values().map(|bytes| bytes.len()).sum();
    if let Ok(model) = meshes::read(&bundle) {
        check(name, &model, all * 64 * 4 + (1 << 20));
    }
}

#[test]
fn damaged_files_neither_panic_nor_take_memory() {
    let attempt = |name: &str, (_, files): &(Vec<u8>, MemoryFiles), bytes: &[u8]| attempt(name, bytes.to_vec(), files);
    fuzz::damaged(&with_files(), |(seed, _)| seed, (7, 2000), attempt);
}

/// `MENISCUS_FUZZ_SECONDS=600 cargo test --test meshes fuzz -- --nocapture`.
#[test]
fn fuzz() {
    fuzz::fuzz(with_files(), |(seed, _)| seed, |name, (_, files), bytes| attempt(name, bytes.to_vec(), files));
}

/// Each seed with the files beside it.
fn with_files() -> Vec<(&'static str, (Vec<u8>, MemoryFiles))> {
    seeds().into_iter().map(|(name, seed, files)| (name, (seed, files))).collect()
}

#[test]
fn whole_seeds_are_read_and_cut_ones_never_panic() {
    for (name, seed, files) in seeds() {
        let whole = files.clone().with(name, &seed);
        let path = Path::new(entry(name));
        let model = meshes::read(&meshes::gather(&whole, path, whole.0[path].clone()));
        assert!(model.is_ok_and(|model| model.triangle_count() > 0), "{name} is no seed");
        for end in 0..seed.len() {
            attempt(name, seed[..end].to_vec(), &files);
        }
    }
}

#[test]
fn counts_are_not_believed() {
    // Each digit of a document in turn becomes a number that nothing can hold.
    let before = peak();
    for (name, seed, files) in seeds().into_iter().filter(|(_, seed, _)| seed.is_ascii() && seed.len() < 8192) {
        for at in (0..seed.len()).filter(|at| seed[*at].is_ascii_digit()) {
            for huge in ["2147483647", "4294967295", "18446744073709551615", "1e39", "-1"] {
                let lying = [&seed[..at], huge.as_bytes(), &seed[at + 1..]].concat();
                attempt(name, lying, &files);
            }
        }
    }
    if let (Some(before), Some(after)) = (before, peak()) {
        assert!(after - before < 1 << 30, "the peak rose by {} MiB", (after - before) >> 20);
    }
}

#[test]
fn a_deep_tree_does_not_end_the_stack() {
    let count = 100_000;
    let mut builder = Builder::triangle();
    let nodes = (0..count).map(|k| if k + 1 < count { json!({"children": [k + 1]}) } else { json!({"mesh": 0}) });
    builder.document["nodes"] = nodes.collect();
    let files = builder.files();
    let bytes: Arc<[u8]> = files.0[Path::new("a.gltf")].clone();
    let model = meshes::read(&meshes::gather(&files, Path::new("a.gltf"), bytes)).unwrap();
    assert_eq!((model.nodes.len(), model.pose(None, 0.0).len()), (count, count));
    // Brackets without end are refused by the reader of JSON.
    let brackets = "[".repeat(100_000);
    let text = format!("{{\"asset\": {{\"version\": \"2.0\"}}, \"extras\": {brackets}");
    assert!(meshes::read(&meshes::Bundle::alone("a.gltf", text.into_bytes().into())).is_err());
}
