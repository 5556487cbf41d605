//! Files that others made, as other readers see them. They lie beside the repository; where they
//! are absent, the tests say so and check nothing.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Mat4, Quat, Vec3, Vec4};
use meniscus::files::DiskFiles;
use meniscus::scene::meshes::{self, Filter, Local, Model, Primitive, Wrap};

use super::said;

fn folder() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: {} is not there", folder.display());
    None
}

fn load(path: &Path) -> Model {
    load_with(path, str::is_empty)
}

/// Loads a file that may be read with findings that are expected.
fn load_with(path: &Path, expected: impl Fn(&str) -> bool) -> Model {
    let bytes: Arc<[u8]> = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).into();
    let bundle = meshes::gather(&DiskFiles, path, bytes);
    let shown = path.display().to_string();
    let model = meshes::read(&bundle).unwrap_or_else(|found| panic!("{}", said(&found, &shown)));
    let found = said(&model.diagnostics, &shown);
    assert!(expected(&found), "{found}");
    model
}

const GLTF: &[&str] = &[
    "BoxAnimated/glTF/BoxAnimated.gltf",
    "BoxAnimated/glTF-Binary/BoxAnimated.glb",
    "BoxAnimated/glTF-Embedded/BoxAnimated.gltf",
    "BoxTextured/glTF/BoxTextured.gltf",
    "BoxTextured/glTF-Binary/BoxTextured.glb",
    "BoxTextured/glTF-Embedded/BoxTextured.gltf",
    "Duck/glTF/Duck.gltf",
    "Duck/glTF-Binary/Duck.glb",
    "Duck/glTF-Embedded/Duck.gltf",
    "Suzanne/glTF/Suzanne.gltf",
];

/// The values at the corners of the triangles, which do not depend on how vertices are numbered.
fn at_corners<T: Copy>(values: &[T], indices: &[u32]) -> Vec<T> {
    indices.iter().map(|index| values[*index as usize]).collect()
}

fn buffers_of(document: &gltf::Gltf, folder: &Path) -> Vec<Vec<u8>> {
    let read = |buffer: gltf::Buffer<'_>| match buffer.source() {
        gltf::buffer::Source::Bin => document.blob.clone().unwrap(),
        gltf::buffer::Source::Uri(uri) => match uri.split_once(";base64,") {
            Some((_, data)) => base64::Engine::decode(&base64::prelude::BASE64_STANDARD, data).unwrap(),
            None => std::fs::read(folder.join(uri)).unwrap(),
        },
    };
    document.buffers().map(read).collect()
}

#[test]
fn samples_of_gltf_are_what_another_reader_finds() {
    let Some(folder) = folder() else { return };
    for name in GLTF {
        let path = folder.join("assets/gltf").join(name);
        let model = load(&path);
        let other = gltf::Gltf::open(&path).unwrap();
        let buffers = buffers_of(&other, path.parent().unwrap());
        assert_eq!(model.meshes.len(), other.meshes().count(), "{name}");
        for (ours, theirs) in model.meshes.iter().zip(other.meshes()) {
            assert_eq!(ours.primitives.len(), theirs.primitives().count(), "{name}");
            for (ours, theirs) in ours.primitives.iter().zip(theirs.primitives()) {
                same_primitive(name, ours, &theirs, &buffers);
                same_material(name, &model, ours.material, &theirs.material());
            }
        }
        same_nodes(name, &model, &other);
    }
}

fn same_primitive(name: &str, ours: &Primitive, theirs: &gltf::Primitive<'_>, buffers: &[Vec<u8>]) {
    let reader = theirs.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    assert_eq!(ours.indices.len(), indices.len(), "{name}");
    let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let same = at_corners(&ours.positions, &ours.indices) == at_corners(&positions, &indices);
    assert!(same, "{name}: positions");
    let normals: Vec<[f32; 3]> = reader.read_normals().unwrap().collect();
    for (a, b) in at_corners(&ours.normals, &ours.indices).iter().zip(at_corners(&normals, &indices)) {
        assert!(Vec3::from_array(*a).distance(Vec3::from_array(b).normalize()) < 1e-6, "{name}: {a:?} {b:?}");
    }
    if let Some(uv) = reader.read_tex_coords(0) {
        let uv: Vec<[f32; 2]> = uv.into_f32().collect();
        assert!(at_corners(&ours.uv0, &ours.indices) == at_corners(&uv, &indices), "{name}: uv0");
    }
    if let Some(tangents) = reader.read_tangents() {
        let tangents: Vec<[f32; 4]> = tangents.collect();
        for (a, b) in at_corners(&ours.tangents, &ours.indices).iter().zip(at_corners(&tangents, &indices)) {
            let (a, b) = (Vec4::from_array(*a), Vec4::from_array(b));
            assert!(a.truncate().distance(b.truncate().normalize()) < 1e-6 && a.w == b.w, "{name}: {a} {b}");
        }
    }
}

fn same_material(name: &str, model: &Model, index: usize, theirs: &gltf::Material<'_>) {
    let ours = &model.materials[index];
    let pbr = theirs.pbr_metallic_roughness();
    assert_eq!(ours.name, theirs.name().unwrap_or_default(), "{name}");
    assert_eq!(ours.base_color_factor, pbr.base_color_factor(), "{name}");
    assert_eq!(
        (ours.metallic_factor, ours.roughness_factor),
        (pbr.metallic_factor(), pbr.roughness_factor()),
        "{name}"
    );
    assert_eq!(ours.double_sided, theirs.double_sided(), "{name}");
    assert_eq!(ours.base_color_texture.is_some(), pbr.base_color_texture().is_some(), "{name}");
    assert_eq!(ours.metallic_roughness_texture.is_some(), pbr.metallic_roughness_texture().is_some(), "{name}");
    if let (Some(ours), Some(theirs)) = (ours.base_color_texture, pbr.base_color_texture()) {
        assert_eq!(ours.uv_set, theirs.tex_coord(), "{name}");
        let sampler = theirs.texture().sampler();
        let repeats = sampler.wrap_s() == gltf::texture::WrappingMode::Repeat;
        assert_eq!((ours.sampler.wrap_u == Wrap::Repeat, ours.sampler.mag), (repeats, Filter::Linear), "{name}");
        let image = &model.images[ours.image];
        assert_eq!(image.texels.len(), (image.width * image.height) as usize, "{name}");
    }
}

fn same_nodes(name: &str, model: &Model, other: &gltf::Gltf) {
    let mut theirs = Vec::new();
    let mut open: Vec<(gltf::Node<'_>, Mat4)> =
        other.default_scene().unwrap().nodes().map(|node| (node, Mat4::IDENTITY)).collect();
    while let Some((node, parent)) = open.pop() {
        let world = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        open.extend(node.children().map(|child| (child, world)));
        theirs.push((node.mesh().map(|m| m.index()), world));
    }
    let ours: Vec<_> = model.nodes.iter().map(|node| node.mesh).zip(model.pose(None, 0.0)).collect();
    assert_eq!(ours.len(), theirs.len(), "{name}");
    for (mesh, world) in ours {
        let same = |(other, matrix): &(Option<usize>, Mat4)| *other == mesh && matrix.abs_diff_eq(world, 1e-5);
        let at = theirs.iter().position(same).unwrap_or_else(|| panic!("{name}: no node at {world}"));
        theirs.swap_remove(at);
    }
}

#[test]
fn all_forms_of_a_sample_are_one_model() {
    let Some(folder) = folder() else { return };
    for name in ["BoxAnimated", "BoxTextured", "Duck"] {
        let of = |form: &str| load(&folder.join(format!("assets/gltf/{name}/{form}")));
        let plain = of(&format!("glTF/{name}.gltf"));
        for form in [format!("glTF-Binary/{name}.glb"), format!("glTF-Embedded/{name}.gltf")] {
            let other = of(&form);
            let faces = |model: &Model| -> Vec<Vec<[f32; 3]>> {
                let primitives = model.meshes.iter().flat_map(|mesh| &mesh.primitives);
                primitives.map(|p| at_corners(&p.positions, &p.indices)).collect()
            };
            assert!(faces(&plain) == faces(&other), "{form}: positions");
            assert!(plain.images == other.images, "{form}: images");
            assert_eq!(plain.pose(Some(0), 1.0), other.pose(Some(0), 1.0), "{form}");
        }
    }
}

#[test]
fn made_tangents_go_the_way_of_a_files_own() {
    let Some(folder) = folder() else { return };
    let path = folder.join("assets/gltf/Suzanne/glTF/Suzanne.gltf");
    let own = load(&path);
    let mut document: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    document["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("TANGENT");
    let without = serde_json::to_vec(&document).unwrap();
    document["materials"][0]["normalTexture"] = serde_json::json!({"index": 0});
    let with_map = serde_json::to_vec(&document).unwrap();
    for document in [without, with_map] {
        let made = meshes::read(&meshes::gather(&DiskFiles, &path, document.into())).unwrap();
        let of = |model: &Model| {
            let primitive = &model.meshes[0].primitives[0];
            at_corners(&primitive.tangents, &primitive.indices)
        };
        let pairs: Vec<_> = of(&own).into_iter().zip(of(&made)).collect();
        // The file's are one for each face, ours one for each vertex of a round thing. Its sign is
        // 1 throughout and says nothing.
        let cosine = |(a, b): &([f32; 4], [f32; 4])| Vec3::from_slice(a).dot(Vec3::from_slice(b));
        let above = |least: f32| pairs.iter().filter(|pair| cosine(pair) > least).count() * 100 / pairs.len();
        assert!(above(0.9) >= 90 && above(0.5) >= 98, "{} {}", above(0.9), above(0.5));
    }
}

#[test]
fn the_animated_box_is_where_its_file_says() {
    let Some(folder) = folder() else { return };
    let model = load(&folder.join("assets/gltf/BoxAnimated/glTF/BoxAnimated.gltf"));
    assert_eq!(model.animations.len(), 1);
    let animation = &model.animations[0];
    // Straight from the accessors of the file: rotation from 1.25 s to 2.5 s half around x;
    // translation by 2.52 along y from 0 s to 1.25 s, back from 2.5 s to 3.708 s.
    assert!((animation.duration_s - 3.708_33).abs() < 1e-4, "{}", animation.duration_s);
    let inner = model.nodes.iter().position(|node| node.mesh == Some(0)).unwrap();
    let root = model.nodes[model.nodes[inner].parent.unwrap()].parent.unwrap();
    let at = |time: f64| {
        let pose = model.pose(Some(0), time);
        (pose[inner].to_scale_rotation_translation(), pose[root].to_scale_rotation_translation())
    };
    let expect = |time: f64, height: f32, angle: f32| {
        let ((_, rotation, place), (_, _, outer)) = at(time);
        assert!((outer.y - height).abs() < 1e-3, "{time} s: {outer}");
        assert!(place.abs_diff_eq(outer, 1e-5), "{time} s: {place} {outer}");
        let turned = Quat::from_rotation_x(angle);
        assert!(rotation.angle_between(turned) < 2e-3, "{time} s: {rotation} {turned}");
    };
    expect(0.0, 0.0, 0.0);
    expect(0.625, 1.26, 0.0);
    expect(1.25, 2.52, 0.0);
    expect(1.875, 2.52, std::f32::consts::FRAC_PI_2);
    expect(2.5, 2.52, std::f32::consts::PI);
    expect(100.0, 0.0, std::f32::consts::PI);
    assert!(model.nodes.iter().all(|node| matches!(node.local, Local::Parts { .. })));
}

#[test]
fn obj_files_are_what_another_reader_finds() {
    let Some(folder) = folder() else { return };
    for (name, triangles) in [("spot", 5856), ("splishsplash_sphere", 760), ("splishsplash_torus", 0)] {
        let path = folder.join(format!("assets/obj/{name}.obj"));
        let model = load_with(&path, |found| found.lines().all(|line| line.contains("mtllib")));
        let (others, _) =
            tobj::load_obj(&path, &tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() }).unwrap();
        let ours = &model.meshes[0].primitives[0];
        let positions: Vec<[f32; 3]> = others
            .iter()
            .flat_map(|other| {
                other.mesh.indices.iter().map(|i| *other.mesh.positions.as_chunks().0.get(*i as usize).unwrap())
            })
            .collect();
        assert!(at_corners(&ours.positions, &ours.indices) == positions, "{name}: positions");
        assert!(triangles == 0 || ours.indices.len() == triangles * 3, "{name}: {}", ours.indices.len());
        let uvs: Vec<[f32; 2]> = others
            .iter()
            .filter(|other| !other.mesh.texcoord_indices.is_empty())
            .flat_map(|other| {
                let uv = other.mesh.texcoords.as_chunks::<2>().0;
                other.mesh.texcoord_indices.iter().map(|i| [uv[*i as usize][0], 1.0 - uv[*i as usize][1]])
            })
            .collect();
        assert!(uvs.is_empty() || at_corners(&ours.uv0, &ours.indices) == uvs, "{name}: uv0");
        outwards(name, ours);
    }
}

#[test]
fn an_obstacle_of_a_simulator_is_a_model() {
    let Some(folder) = folder() else { return };
    let model = load(&folder.join("bakes/dd_sphere_20_obstacle.vtk"));
    let primitive = &model.meshes[0].primitives[0];
    assert_eq!((primitive.positions.len(), primitive.indices.len()), (382, 760 * 3));
    outwards("obstacle", primitive);
    let bounds = model.bounds(&model.pose(None, 0.0)).unwrap();
    let (middle, radius) = ((bounds.min + bounds.max) / 2.0, (bounds.max - bounds.min) / 2.0);
    for (position, normal) in primitive.positions.iter().zip(&primitive.normals) {
        let out = Vec3::from_array(*position) - middle;
        assert!((out.length() - radius.x).abs() < 0.02 * radius.x, "a sphere: {out} {radius}");
        assert!(out.normalize().dot(Vec3::from_array(*normal)) > 0.99);
    }
}

/// The normals of a closed mesh point away from what it encloses, and lean to their triangles.
fn outwards(name: &str, primitive: &Primitive) {
    let mut volume = 0.0;
    for triangle in primitive.indices.as_chunks::<3>().0 {
        let [a, b, c] = triangle.map(|index| Vec3::from_array(primitive.positions[index as usize]));
        volume += a.dot(b.cross(c));
        let normals: Vec3 = triangle.iter().map(|index| Vec3::from_array(primitive.normals[*index as usize])).sum();
        assert!((b - a).cross(c - a).dot(normals) >= 0.0, "{name}: {triangle:?}");
    }
    assert!(volume > 0.0, "{name}");
}
