//! OBJ and its materials.

use glam::Vec3;
use meniscus::files::MemoryFiles;
use meniscus::scene::meshes::{AlphaMode, Material, Model, Primitive, Wrap};

use super::build::png;
use super::{read, said, whole};

fn obj(text: &str) -> Model {
    whole(&MemoryFiles::default().with("a.obj", text), "a.obj")
}

fn first(text: &str) -> Primitive {
    obj(text).meshes[0].primitives[0].clone()
}

fn corners(primitive: &Primitive) -> Vec<[f32; 3]> {
    primitive.indices.iter().map(|index| primitive.positions[*index as usize]).collect()
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn faces_in_all_their_forms() {
    let expected = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for face in ["1 2 3", "-3 -2 -1", "1/1 2/2 3/3", "1//1 2//1 3//1", "1/1/1 2/2/1 3/3/1", "1/ 2/ 3//", "1 2 \\\n 3"] {
        let text = format!("{TRIANGLE}vt 0 0\nvt 1 0.25 0\nvt 0.5\nvn 0 0 2\nf {face} # a comment\n");
        let primitive = first(&text);
        assert_eq!(corners(&primitive), expected, "{face}");
        assert_eq!(primitive.normals, [[0.0, 0.0, 1.0]; 3], "{face}");
        if face.starts_with("1/1") {
            assert_eq!(primitive.uv0, [[0.0, 1.0], [1.0, 0.75], [0.5, 1.0]], "v is turned over");
        }
    }
    // Faces may stand before their vertices, and lines may end as on other systems.
    assert_eq!(corners(&first(&format!("f 1 2 3\r\n{}", TRIANGLE.replace('\n', "\r\n")))), expected);
}

#[test]
fn polygons_become_triangles() {
    // A face of 50 vertices, and one of four that points inwards at its second.
    let circle: Vec<(f32, f32)> = (0..50).map(|k| (k as f32 / 50.0 * std::f32::consts::TAU).sin_cos()).collect();
    let vertices: String = circle.iter().map(|(y, x)| format!("v {x} {y} 0\n")).collect();
    let face: String = (1..=50).map(|k| format!(" {k}")).collect();
    let primitive = first(&format!("{vertices}f{face}\n"));
    assert_eq!(primitive.indices.len(), 48 * 3);
    let area: f32 = corners(&primitive)
        .as_chunks::<3>()
        .0
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(Vec3::from_array);
            (b - a).cross(c - a).z / 2.0
        })
        .sum();
    assert!((area - 25.0 * (std::f32::consts::TAU / 50.0).sin()).abs() < 1e-4, "{area}");
    let dart = first("v 0 0 0\nv 1 0.5 0\nv 2 0 0\nv 1 2 0\nf 1 2 3 4\n");
    assert_eq!(dart.indices.len(), 6);
    assert!(dart.normals.iter().all(|normal| *normal == [0.0, 0.0, 1.0]));
}

/// Two squares that meet at a right angle along the axis x.
const FOLD: &str = "v 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 0 -1\nv 1 -1 0\nv 0 -1 0\n";

#[test]
fn smoothing_groups_decide_which_faces_share_normals() {
    let both = "f 1 2 3 4\nf 2 1 6 5\n";
    let at_edge = |text: &str| -> Vec<Vec3> {
        let primitive = first(text);
        let vertices = primitive.positions.iter().zip(&primitive.normals);
        vertices.filter(|(p, _)| p[1] == 0.0 && p[2] == 0.0).map(|(_, n)| Vec3::from_array(*n)).collect()
    };
    let half = Vec3::new(0.0, 1.0, 1.0).normalize();
    for smooth in [both.to_owned(), format!("s 1\n{both}"), format!("s 7\n{both}")] {
        let normals = at_edge(&format!("{FOLD}{smooth}"));
        assert_eq!(normals.len(), 2);
        assert!(normals.iter().all(|normal| normal.distance(half) < 1e-6), "{normals:?}");
    }
    for flat in [format!("s off\n{both}"), format!("s 0\n{both}"), "s 1\nf 1 2 3 4\ns 2\nf 2 1 6 5\n".to_owned()] {
        let normals = at_edge(&format!("{FOLD}{flat}"));
        assert_eq!(normals.len(), 4, "{flat}");
        assert!(normals.iter().all(|n| n.distance(Vec3::Y) < 1e-6 || n.distance(Vec3::Z) < 1e-6), "{normals:?}");
    }
}

#[test]
fn colours_of_vertices_are_srgb() {
    let primitive = first("v 0 0 0 1 0.5 0\nv 1 0 0 1.0 0 0 1\nv 0 1 0\nf 1 2 3\n");
    assert!((primitive.color0[0][1] - 0.21404).abs() < 1e-4, "{:?}", primitive.color0);
    assert_eq!((primitive.color0[1], primitive.color0[2]), ([0.0, 0.0, 1.0, 1.0], [1.0; 4]));
}

fn material(text: &str, files: MemoryFiles) -> (Material, Model) {
    let obj = format!("mtllib my things.mtl\n{TRIANGLE}vt 0 0\nusemtl the one\nf 1/1 2/1 3/1\n");
    let files = files.with("x/a.obj", obj).with("x/my things.mtl", format!("newmtl the one\n{text}"));
    let model = whole(&files, "x/a.obj");
    (model.materials[0].clone(), model)
}

fn plain(text: &str) -> Material {
    material(text, MemoryFiles::default()).0
}

#[test]
fn materials_come_to_metallic_roughness() {
    let nothing = plain("");
    assert_eq!(nothing, Material { name: "the one".into(), ..Material::plain() });
    let old = plain("Ka 1 1 1\nKd 0.1 0.2 0.3\nKs 1 1 1\nNs 30\nNi 1.45\nd 0.5\nillum 2\nKe 2 4 1\n");
    assert_eq!(old.base_color_factor, [0.1, 0.2, 0.3, 0.5]);
    assert_eq!((old.metallic_factor, old.alpha_mode, old.ior), (0.0, AlphaMode::Blend, 1.45));
    assert!((old.roughness_factor - 0.5).abs() < 1e-6, "(2 / 32)^(1/4) is a half: {}", old.roughness_factor);
    assert_eq!((old.emissive_factor, old.emissive_strength), ([0.5, 1.0, 0.25], 4.0));
    let new = plain("Kd 0.5\nNs 30\nTr 0.25\nPr 0.3\nPm 1\n");
    assert_eq!(new.base_color_factor, [0.5, 0.5, 0.5, 0.75]);
    assert_eq!((new.metallic_factor, new.roughness_factor), (1.0, 0.3));
}

#[test]
fn pictures_of_materials_with_their_options() {
    let files = || {
        MemoryFiles::default()
            .with("x/skin.png", png(&[[10, 20, 30, 255], [40, 50, 60, 255]]))
            .with("x/rough map.png", png(&[[100; 4], [200; 4]]))
            .with("x/metal.png", png(&[[0, 0, 0, 255], [255; 4]]))
            .with("x/holes.png", png(&[[0, 0, 0, 255], [255; 4]]))
            .with("x/normal.png", png(&[[128, 128, 255, 255]; 2]))
    };
    let (found, model) = material(
        "Kd 0 0 0\nmap_Kd -s 2 3 1 -o 0.5 0.25 -clamp on -blendu on skin.png\nmap_Pr rough map.png\nmap_Pm metal.png\n\
         map_Bump -bm 0.5 normal.png\nmap_Ke skin.png\nmap_d holes.png\n",
        files(),
    );
    let texels = |index: usize| model.images[index].texels.clone();
    let base = found.base_color_texture.unwrap();
    assert_eq!(texels(base.image), [[10, 20, 30, 0], [40, 50, 60, 255]], "coverage is alpha");
    assert_eq!(found.alpha_mode, AlphaMode::Mask);
    assert_eq!(found.base_color_factor, [1.0; 4], "a factor of 0 under a picture counts as 1");
    // At the bottom of a picture, v = 0 of OBJ: 0 * 3 + 0.25 from there, so 0.75 from the top.
    assert_eq!((base.transform.offset, base.transform.scale), ([0.5, -2.25], [2.0, 3.0]));
    assert_eq!(base.transform.offset[1] + base.transform.scale[1] * 1.0, 0.75);
    assert_eq!((base.sampler.wrap_u, base.sampler.wrap_v), (Wrap::Clamp, Wrap::Clamp));
    let both = found.metallic_roughness_texture.unwrap();
    assert_eq!(texels(both.image), [[255, 100, 0, 255], [255, 200, 255, 255]]);
    assert_eq!((found.roughness_factor, found.metallic_factor), (1.0, 1.0));
    assert_eq!(found.normal_scale, 0.5);
    assert_eq!(texels(found.normal_texture.unwrap().image)[0], [128, 128, 255, 255]);
    assert_eq!((found.emissive_factor, found.emissive_texture.unwrap().sampler.wrap_u), ([1.0; 3], Wrap::Repeat));
}

#[test]
fn each_material_is_a_primitive() {
    let text = "mtllib a.mtl b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 2 3\nusemtl red\nf 3 2 1\n";
    let files = MemoryFiles::default()
        .with("a.obj", text)
        .with("a.mtl", "newmtl red\nKd 1 0 0\n")
        .with("b.mtl", "newmtl blue\nKd 0 0 1\n");
    let model = whole(&files, "a.obj");
    let found: Vec<_> = model.meshes[0]
        .primitives
        .iter()
        .map(|p| {
            (model.materials[p.material].name.as_str(), p.indices.len(), model.materials[p.material].base_color_factor)
        })
        .collect();
    let grey = Material::plain().base_color_factor;
    assert_eq!(found, [("", 3, grey), ("red", 6, [1.0, 0.0, 0.0, 1.0]), ("blue", 3, [0.0, 0.0, 1.0, 1.0])]);
}

#[test]
fn files_that_are_not_there_are_waited_for() {
    let files = MemoryFiles::default()
        .with("x/a.obj", format!("mtllib sub/a.mtl\n{TRIANGLE}usemtl m\nf 1 2 3\n"))
        .with("x/sub/a.mtl", "newmtl m\nmap_Kd tex/skin.png\n");
    let bytes = files.0[std::path::Path::new("x/a.obj")].clone();
    let bundle = meniscus::scene::meshes::gather(&files, std::path::Path::new("x/a.obj"), bytes);
    let looked_at: Vec<_> = bundle.looked_at.iter().map(|path| path.display().to_string()).collect();
    assert_eq!(looked_at, ["x/sub/a.mtl", "x/sub/tex/skin.png"]);
    let before = bundle.hash();
    let more = files.with("x/sub/tex/skin.png", png(&[[1, 2, 3, 255]]));
    let model = whole(&more, "x/a.obj");
    assert_eq!(model.images[0].texels, [[1, 2, 3, 255]]);
    let bytes = more.0[std::path::Path::new("x/a.obj")].clone();
    assert_ne!(meniscus::scene::meshes::gather(&more, std::path::Path::new("x/a.obj"), bytes).hash(), before);
}

#[test]
fn what_is_no_surface_is_said() {
    let text = format!("{TRIANGLE}l 1 2\np 1\ncstype bezier\nwhat 1\nf 1 2\nf 1 2 3\n");
    let model = read(&MemoryFiles::default().with("a.obj", text), "a.obj").unwrap();
    let expected = "warning: line 7: `what` is no statement of OBJ\n\
                    warning: line 8: a face of 2 corners is left out\n\
                    warning: line 4: lines and points are not read\n\
                    warning: line 6: curves and surfaces are not read\n";
    assert_eq!(said(&model.diagnostics, "a.obj"), expected);
}

#[test]
fn keywords_of_materials_are_known_however_they_are_spelt() {
    let files = MemoryFiles::default().with("x/a.png", png(&[[1, 2, 3, 255]]));
    let (found, model) = material("kd 0.1 0.2 0.3\nPR 0.5\nmap_kd a.png\nMAP_bump a.png\n", files);
    assert_eq!(found.base_color_factor, [0.1, 0.2, 0.3, 1.0]);
    assert_eq!(found.roughness_factor, 0.5);
    assert!(found.base_color_texture.is_some() && found.normal_texture.is_some());
    assert_eq!(model.images.len(), 1);
}

#[test]
fn whole_paths_of_another_computer_lead_to_files_beside() {
    let files = MemoryFiles::default()
        .with("x/a.obj", format!("mtllib C:\\work\\sub.mtl\n{TRIANGLE}usemtl m\nf 1 2 3\n"))
        .with("x/sub.mtl", "newmtl m\nmap_Kd C:\\Users\\me\\skin.png\nmap_Ke tex\\glow.png\n")
        .with("x/skin.png", png(&[[1, 2, 3, 255]]))
        .with("x/tex/glow.png", png(&[[4, 5, 6, 255]]))
        .with("Users/me/skin.png", png(&[[9; 4]]));
    let model = read(&files, "x/a.obj").unwrap();
    let texels: Vec<_> = model.images.iter().map(|image| image.texels[0]).collect();
    assert_eq!(texels, [[1, 2, 3, 255], [4, 5, 6, 255]]);
    let expected = "note: line 1, mtllib: `C:/work/sub.mtl` is a path of elsewhere: `sub.mtl` is read\n\
                    note: sub.mtl, line 1: `C:/Users/me/skin.png` is a path of elsewhere: `skin.png` is read\n";
    assert_eq!(said(&model.diagnostics, "x/a.obj"), expected);
}

#[test]
fn names_with_spaces_stand_on_one_line_with_others() {
    let files = MemoryFiles::default()
        .with("a.obj", format!("mtllib my own.mtl  other.mtl\n{TRIANGLE}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n"))
        .with("my own.mtl", "newmtl a\nKd 1 0 0\n")
        .with("other.mtl", "newmtl b\nKd 0 1 0\n");
    let found = whole(&files, "a.obj");
    let colors: Vec<_> = found.materials.iter().map(|material| material.base_color_factor[..2].to_vec()).collect();
    assert_eq!(colors, [[1.0, 0.0], [0.0, 1.0]]);
}
