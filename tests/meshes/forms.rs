//! Every form in which glTF may say the same.

use glam::{Mat4, Quat, Vec3};
use meniscus::files::MemoryFiles;
use meniscus::scene::meshes::{AlphaMode, Filter, LampKind, LensKind, Material, Model, Primitive, Sampler, Wrap};
use serde_json::json;

use super::build::{Builder, F32, I8, I16, U8, U16, U32, bytes, glb, png};
use super::{read, said, whole};

/// A square of the plane z = 0 from two triangles.
const SQUARE: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];

fn square() -> Builder {
    let mut builder = Builder::new();
    builder.attribute("POSITION", "VEC3", F32, &SQUARE);
    builder
}

fn model(builder: &Builder) -> Model {
    whole(&builder.files(), "a.gltf")
}

fn primitive(builder: &Builder) -> Primitive {
    model(builder).meshes[0].primitives[0].clone()
}

fn corners(primitive: &Primitive) -> Vec<[f32; 3]> {
    primitive.indices.iter().map(|index| primitive.positions[*index as usize]).collect()
}

/// The corners of the square by number.
fn expect(primitive: &Primitive, numbers: &[usize]) {
    let expected: Vec<[f32; 3]> =
        numbers.iter().map(|n| std::array::from_fn(|axis| SQUARE[n * 3 + axis] as f32)).collect();
    assert_eq!(corners(primitive), expected);
}

#[test]
fn indices_of_all_kinds_and_none() {
    let numbers = [0.0, 1.0, 2.0, 0.0, 2.0, 3.0];
    for kind in [U8, U16, U32] {
        let mut builder = square();
        builder.indices(kind, &numbers);
        expect(&primitive(&builder), &[0, 1, 2, 0, 2, 3]);
    }
    let mut builder = Builder::new();
    let flat: Vec<f64> = numbers.iter().flat_map(|n| SQUARE[*n as usize * 3..][..3].to_vec()).collect();
    builder.attribute("POSITION", "VEC3", F32, &flat);
    expect(&primitive(&builder), &[0, 1, 2, 0, 2, 3]);
}

#[test]
fn strips_and_fans_keep_their_front() {
    let mut strip = square();
    strip.primitive()["mode"] = json!(5);
    strip.indices(U16, &[0.0, 1.0, 3.0, 2.0, 2.0, 0.0]);
    // The repeated index makes triangles without area, which are left out.
    expect(&primitive(&strip), &[0, 1, 3, 1, 2, 3]);
    let mut fan = square();
    fan.primitive()["mode"] = json!(6);
    expect(&primitive(&fan), &[1, 2, 0, 2, 3, 0]);
    for builder in [strip, fan] {
        assert!(primitive(&builder).normals.iter().all(|normal| *normal == [0.0, 0.0, 1.0]));
    }
}

#[test]
fn interleaved_attributes_are_taken_apart() {
    let mut builder = Builder::new();
    let rows: Vec<f64> = (0..4)
        .flat_map(|n| {
            let mut row = SQUARE[n * 3..][..3].to_vec();
            row.extend([0.0, 0.0, 1.0, n as f64, 0.5]);
            row
        })
        .collect();
    let view = builder.view(&bytes(F32, &rows));
    builder.document["bufferViews"][view]["byteStride"] = json!(32);
    for (name, shape, offset) in [("POSITION", "VEC3", 0), ("NORMAL", "VEC3", 12), ("TEXCOORD_0", "VEC2", 24)] {
        let accessor =
            json!({"bufferView": view, "byteOffset": offset, "componentType": F32, "count": 4, "type": shape});
        let accessor = builder.push("accessors", accessor);
        builder.primitive()["attributes"][name] = json!(accessor);
    }
    builder.indices(U8, &[0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
    let primitive = primitive(&builder);
    expect(&primitive, &[0, 1, 2, 0, 2, 3]);
    assert_eq!(primitive.uv0, [[0.0, 0.5], [1.0, 0.5], [2.0, 0.5], [3.0, 0.5]]);
    assert_eq!(primitive.normals, [[0.0, 0.0, 1.0]; 4]);
}

#[test]
fn sparse_values_replace_others_or_zeros() {
    for has_base in [true, false] {
        let mut builder = square();
        builder.indices(U8, &[0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
        let places = builder.view(&bytes(U16, &[1.0, 3.0]));
        let values = builder.view(&bytes(F32, &[5.0, 6.0, 7.0, 8.0, 9.0, 10.0]));
        let accessor = &mut builder.document["accessors"][0];
        accessor["sparse"] = json!({
            "count": 2,
            "indices": {"bufferView": places, "componentType": U16},
            "values": {"bufferView": values},
        });
        if !has_base {
            accessor.as_object_mut().unwrap().remove("bufferView");
        }
        let third = if has_base { [1.0, 1.0, 0.0] } else { [0.0; 3] };
        let expected = [[0.0; 3], [5.0, 6.0, 7.0], third, [0.0; 3], third, [8.0, 9.0, 10.0]];
        assert_eq!(corners(&primitive(&builder)), expected);
    }
}

#[test]
fn whole_numbers_are_scaled_where_they_are_normalized() {
    let cases = [(U8, 255.0, 0.0), (U16, 65535.0, 0.0), (I8, 127.0, -128.0), (I16, 32767.0, -32768.0)];
    for (kind, most, least) in cases {
        let mut builder = Builder::triangle();
        let uv = builder.attribute("TEXCOORD_0", "VEC2", kind, &[most, 0.0, least, most, 0.0, 0.0]);
        builder.document["accessors"][uv]["normalized"] = json!(true);
        let least = if least < 0.0 { -1.0 } else { 0.0 };
        assert_eq!(primitive(&builder).uv0, [[1.0, 0.0], [least, 1.0], [0.0, 0.0]]);
    }
    let mut builder = Builder::new();
    builder.attribute("POSITION", "VEC3", U16, &[0.0, 0.0, 0.0, 300.0, 0.0, 0.0, 0.0, 300.0, 0.0]);
    builder.document["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    builder.document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    assert_eq!(corners(&primitive(&builder))[1], [300.0, 0.0, 0.0]);
}

#[test]
fn colours_have_three_or_four_parts() {
    for (kind, one) in [(F32, 1.0), (U8, 255.0), (U16, 65535.0)] {
        for parts in [3, 4] {
            let mut builder = Builder::triangle();
            let mut row = vec![one, 0.0, one];
            row.extend(vec![0.0; parts - 3]);
            // Rows of three bytes are padded to four.
            let padding = if parts == 3 { (4 - 3 * bytes(kind, &[0.0]).len() % 4) % 4 } else { 0 };
            let mut content = Vec::new();
            for _ in 0..3 {
                content.extend(bytes(kind, &row));
                content.extend(vec![0; padding]);
            }
            let view = builder.view(&content);
            builder.document["bufferViews"][view]["byteStride"] = json!(content.len() / 3);
            let accessor = builder.push(
                "accessors",
                json!({"bufferView": view, "componentType": kind, "count": 3, "type": format!("VEC{parts}"),
                       "normalized": kind != F32}),
            );
            builder.primitive()["attributes"]["COLOR_0"] = json!(accessor);
            let alpha = if parts == 3 { 1.0 } else { 0.0 };
            assert_eq!(primitive(&builder).color0, [[1.0, 0.0, 1.0, alpha]; 3], "{kind} {parts}");
        }
    }
}

#[test]
fn what_a_file_leaves_out_has_a_default() {
    let model = model(&Builder::triangle());
    let primitive = &model.meshes[0].primitives[0];
    assert_eq!(primitive.normals, [[0.0, 0.0, 1.0]; 3]);
    assert_eq!((&primitive.uv0[..], &primitive.uv1[..]), (&[[0.0; 2]; 3][..], &[[0.0; 2]; 3][..]));
    assert_eq!(primitive.color0, [[1.0; 4]; 3]);
    assert_eq!(model.materials, [Material::default()]);
    for tangent in &primitive.tangents {
        let along = Vec3::from_slice(tangent);
        assert!((along.length() - 1.0).abs() < 1e-6 && along.z.abs() < 1e-6, "{tangent:?}");
    }
}

#[test]
fn tangents_go_along_u_and_bitangents_up_the_picture() {
    // An upright picture: u to the right, v downwards.
    let upright = [0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
    let mirrored: Vec<f64> = upright.chunks(2).flat_map(|uv| [1.0 - uv[0], uv[1]]).collect();
    let turned: Vec<f64> = upright.chunks(2).flat_map(|uv| [uv[1], 1.0 - uv[0]]).collect();
    let cases =
        [(upright.to_vec(), Vec3::X, Vec3::Y), (mirrored, Vec3::NEG_X, Vec3::Y), (turned, Vec3::NEG_Y, Vec3::X)];
    for (uv, tangent, bitangent) in cases {
        for has_map in [false, true] {
            let mut builder = square();
            builder.indices(U8, &[0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
            builder.attribute("NORMAL", "VEC3", F32, &[0.0, 0.0, 1.0].repeat(4));
            builder.attribute("TEXCOORD_1", "VEC2", F32, &uv);
            builder.attribute("TEXCOORD_0", "VEC2", F32, if has_map { &[0.0; 8] } else { &uv });
            if has_map {
                textured(&mut builder, json!({"normalTexture": {"index": 0, "texCoord": 1}}));
            }
            let files = builder.files().with("a.png", png(&[[128, 128, 255, 255]]));
            let primitive = whole(&files, "a.gltf").meshes[0].primitives[0].clone();
            for (normal, found) in primitive.normals.iter().zip(&primitive.tangents) {
                let [x, y, z, w] = *found;
                let along = Vec3::new(x, y, z);
                assert!(along.distance(tangent) < 1e-5, "{found:?} {tangent}");
                let up = w * Vec3::from_array(*normal).cross(along);
                assert!(up.distance(bitangent) < 1e-5, "map {has_map}: {up} {bitangent}");
            }
        }
    }
}

/// Gives the first primitive a material, and the file one texture.
fn textured(builder: &mut Builder, material: serde_json::Value) {
    builder.push("images", json!({"uri": "a.png"}));
    builder.push("textures", json!({"source": 0}));
    let material = builder.push("materials", material);
    builder.primitive()["material"] = json!(material);
}

#[test]
fn vertices_that_a_primitive_does_not_use_are_left_out() {
    let mut builder = square();
    builder.indices(U8, &[2.0, 3.0, 0.0]);
    builder.attribute("NORMAL", "VEC3", F32, &[0.0, 0.0, 1.0].repeat(4));
    let primitive = primitive(&builder);
    assert_eq!(primitive.positions, [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(primitive.indices, [1, 2, 0]);
}

#[test]
fn samplers_have_all_wraps_and_filters() {
    let mips = |code: u32| match code {
        9728 => (Filter::Nearest, None),
        9729 => (Filter::Linear, None),
        9984 => (Filter::Nearest, Some(Filter::Nearest)),
        9985 => (Filter::Linear, Some(Filter::Nearest)),
        9986 => (Filter::Nearest, Some(Filter::Linear)),
        _ => (Filter::Linear, Some(Filter::Linear)),
    };
    let wraps = [(10497, Wrap::Repeat), (33071, Wrap::Clamp), (33648, Wrap::Mirror)];
    for (at, code) in [9728, 9729, 9984, 9985, 9986, 9987].into_iter().enumerate() {
        let ((s, wrap_u), (t, wrap_v)) = (wraps[at % 3], wraps[(at + 1) % 3]);
        let (mag_code, mag) = [(9728, Filter::Nearest), (9729, Filter::Linear)][at % 2];
        let mut builder = Builder::triangle();
        textured(&mut builder, json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
        builder.push("samplers", json!({"magFilter": mag_code, "minFilter": code, "wrapS": s, "wrapT": t}));
        builder.document["textures"][0]["sampler"] = json!(0);
        let model = whole(&builder.files().with("a.png", png(&[[1, 2, 3, 4]])), "a.gltf");
        let (min, mip) = mips(code);
        let texture = model.materials[0].base_color_texture.unwrap();
        assert_eq!(texture.sampler, Sampler { wrap_u, wrap_v, mag, min, mip });
        assert_eq!(model.images[texture.image].texels, [[1, 2, 3, 4]], "as the file stores them");
    }
}

#[test]
fn materials_have_all_that_they_say() {
    let mut builder = Builder::triangle();
    let used = |strength: serde_json::Value| {
        let mut used = json!({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform":
            {"offset": [0.5, 0.25], "rotation": 0.75, "scale": [2.0, 3.0]}}});
        used.as_object_mut().unwrap().extend(strength.as_object().unwrap().clone());
        used
    };
    let material = json!({
        "name": "all",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6,
            "baseColorTexture": used(json!({})), "metallicRoughnessTexture": used(json!({})),
        },
        "normalTexture": used(json!({"scale": -2.0})), "occlusionTexture": used(json!({"strength": 0.7})),
        "emissiveTexture": used(json!({})), "emissiveFactor": [0.8, 0.9, 1.0],
        "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
        "extensions": {
            "KHR_materials_unlit": {}, "KHR_materials_ior": {"ior": 1.33},
            "KHR_materials_emissive_strength": {"emissiveStrength": 5.0},
            "KHR_materials_transmission": {"transmissionFactor": 0.5},
        },
    });
    textured(&mut builder, material);
    let model = read(&builder.files().with("a.png", png(&[[0; 4]])), "a.gltf").unwrap();
    let found = &model.materials[0];
    assert_eq!(found.base_color_factor, [0.1, 0.2, 0.3, 0.4]);
    assert_eq!((found.metallic_factor, found.roughness_factor), (0.5, 0.6));
    assert_eq!((found.emissive_factor, found.emissive_strength), ([0.8, 0.9, 1.0], 5.0));
    assert_eq!((found.normal_scale, found.occlusion_strength), (-2.0, 0.7));
    assert_eq!((found.alpha_mode, found.alpha_cutoff, found.double_sided), (AlphaMode::Mask, 0.25, true));
    assert_eq!((found.ior, found.transmission_factor, found.unlit), (1.33, 0.5, true));
    let textures = [
        found.base_color_texture,
        found.metallic_roughness_texture,
        found.normal_texture,
        found.occlusion_texture,
        found.emissive_texture,
    ];
    for texture in textures {
        let texture = texture.unwrap();
        assert_eq!((texture.image, texture.uv_set), (0, 1));
        assert_eq!(texture.sampler, Sampler::default());
        assert_eq!(texture.transform.offset, [0.5, 0.25]);
        assert_eq!((texture.transform.rotation, texture.transform.scale), (0.75, [2.0, 3.0]));
    }
    assert_eq!(model.images.len(), 1, "one image is decoded once");
    for (word, mode) in [("OPAQUE", AlphaMode::Opaque), ("BLEND", AlphaMode::Blend)] {
        builder.document["materials"][0]["alphaMode"] = json!(word);
        let model = read(&builder.files().with("a.png", png(&[[0; 4]])), "a.gltf").unwrap();
        assert_eq!(model.materials[0].alpha_mode, mode);
    }
}

#[test]
fn data_may_stand_anywhere() {
    let mut builder = square();
    builder.indices(U8, &[0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
    let plain = model(&builder);
    let same = |files: &MemoryFiles, path: &str| {
        let other = whole(files, path);
        assert_eq!(plain.meshes, other.meshes);
    };
    same(&MemoryFiles::default().with("a.glb", builder.glb()), "a.glb");
    // The name does not decide which form it is.
    same(&MemoryFiles::default().with("a.gltf", builder.glb()), "a.gltf");
    let base64 = base64::Engine::encode(&base64::prelude::BASE64_STANDARD, &builder.binary);
    let percent: String = builder.binary.iter().map(|byte| format!("%{byte:02x}")).collect();
    for uri in [
        format!("data:application/octet-stream;base64,{base64}"),
        format!("data:application/gltf-buffer;base64,{}", base64.trim_end_matches('=')),
        format!("data:,{percent}"),
    ] {
        let mut embedded = builder.document.clone();
        embedded["buffers"][0]["uri"] = json!(uri);
        let text = serde_json::to_vec(&embedded).unwrap();
        same(&MemoryFiles::default().with("a.gltf", text), "a.gltf");
    }
    builder.document["buffers"][0]["uri"] = json!("my%20folder/data%C3%A4.bin");
    let text = [b"\xef\xbb\xbf".to_vec(), serde_json::to_vec(&builder.document).unwrap()].concat();
    let files = MemoryFiles::default().with("x/a.gltf", text).with("x/my folder/dataä.bin", &builder.binary);
    same(&files, "x/a.gltf");
    // A picture in the binary chunk of a file of one piece.
    let picture = builder.view(&png(&[[9, 8, 7, 6]]));
    builder.push("images", json!({"bufferView": picture, "mimeType": "image/png"}));
    builder.push("textures", json!({"source": 0}));
    builder.push("materials", json!({"emissiveTexture": {"index": 0}}));
    let model = whole(&MemoryFiles::default().with("a.glb", builder.glb()), "a.glb");
    assert_eq!(model.images[0].texels, [[9, 8, 7, 6]]);
    // A chunk that nobody knows is read over.
    let mut more = glb(b"{\"asset\": {\"version\": \"2.0\"}}", b"");
    more.extend([4, 0, 0, 0, b'X', b'Y', b'Z', b'W', 1, 2, 3, 4]);
    let length = more.len() as u32;
    more[8..12].copy_from_slice(&length.to_le_bytes());
    let found = read(&MemoryFiles::default().with("a.glb", more), "a.glb").unwrap();
    assert_eq!(said(&found.diagnostics, "a.glb"), "warning: the file draws no triangles\n");
}

#[test]
fn the_tree_is_the_scenes() {
    let mut builder = Builder::triangle();
    builder.document["nodes"] = json!([
        {"name": "leaf", "mesh": 0, "translation": [0, 0, 1]},
        {"name": "elsewhere", "mesh": 0},
        {"name": "root", "children": [3], "scale": [2, 2, 2]},
        {"name": "matrix", "children": [0, 4], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1]},
        {"name": "seen", "camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
    ]);
    builder.document["scenes"] = json!([{"nodes": [2]}]);
    builder.document["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 3, "spot": {"outerConeAngle": 0.5}}]}});
    builder.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}));
    let model = |builder: &Builder| read(&builder.files(), "a.gltf").unwrap();
    let found = model(&builder);
    let names: Vec<&str> = found.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["root", "matrix", "leaf", "seen"]);
    assert_eq!(found.roots, [0]);
    assert_eq!((found.nodes[2].parent, &found.nodes[1].children[..]), (Some(1), &[2, 3][..]));
    let pose = found.pose(None, 0.0);
    assert_eq!(pose[2].transform_point3(Vec3::ZERO), Vec3::new(20.0, 0.0, 2.0));
    let bounds = found.bounds(&pose).unwrap();
    assert_eq!((bounds.min, bounds.max), (Vec3::new(20.0, 0.0, 2.0), Vec3::new(22.0, 2.0, 2.0)));
    assert_eq!(
        found.cameras[found.nodes[3].camera.unwrap()].kind,
        LensKind::Perspective { yfov: 0.5, aspect: None, znear: 0.1, zfar: None }
    );
    let lamp = &found.lights[found.nodes[3].light.unwrap()];
    assert_eq!(lamp.kind, LampKind::Spot { inner_cone_angle: 0.0, outer_cone_angle: 0.5 });
    assert_eq!((lamp.color, lamp.intensity, lamp.range), ([1.0; 3], 3.0, None));
    // Without scenes all that has no parent is drawn.
    let document = builder.document.as_object_mut().unwrap();
    document.remove("scenes");
    document.remove("scene");
    assert_eq!(model(&builder).nodes.len(), 5);
}

/// Moves the first node by keys at 1 s, 2 s and 4 s.
fn animated(path: &str, shape: &str, how: &str, values: &[f64]) -> Model {
    let mut builder = Builder::triangle();
    let input = builder.accessor("SCALAR", F32, &[1.0, 2.0, 4.0]);
    let output = builder.accessor(shape, F32, values);
    builder.push(
        "animations",
        json!({"name": "move", "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}],
               "samplers": [{"input": input, "output": output, "interpolation": how}]}),
    );
    model(&builder)
}

fn place(model: &Model, time: f64) -> Vec3 {
    let animation = model.animation("move");
    assert!(animation.is_some());
    model.pose(animation, time)[0].w_axis.truncate()
}

#[test]
fn nodes_move_in_lines_in_steps_and_along_splines() {
    let keys = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 4.0, 0.0];
    let linear = animated("translation", "VEC3", "LINEAR", &keys);
    assert_eq!(linear.animations[0].duration_s, 4.0);
    for (time, expected) in [
        (0.0, Vec3::ZERO),
        (1.0, Vec3::ZERO),
        (1.5, Vec3::new(0.5, 0.0, 0.0)),
        (2.0, Vec3::X),
        (3.5, Vec3::new(1.0, 3.0, 0.0)),
        (9.0, Vec3::new(1.0, 4.0, 0.0)),
    ] {
        assert!(place(&linear, time).abs_diff_eq(expected, 1e-6), "{time}");
    }
    let step = animated("translation", "VEC3", "STEP", &keys);
    for (time, expected) in [(1.999, Vec3::ZERO), (2.0, Vec3::X), (3.999, Vec3::X), (4.0, Vec3::new(1.0, 4.0, 0.0))] {
        assert_eq!(place(&step, time), expected, "{time}");
    }
    // x(t) = t^3 has the derivative 3 t^2, and a cubic spline through it is the cube itself.
    let cube: Vec<f64> = [1.0f64, 2.0, 4.0]
        .iter()
        .flat_map(|t| [3.0 * t * t, 0.0, 0.0, t * t * t, 0.0, 0.0, 3.0 * t * t, 0.0, 0.0])
        .collect();
    let cubic = animated("translation", "VEC3", "CUBICSPLINE", &cube);
    for time in [1.0, 1.25, 1.75, 2.0, 2.5, 3.5, 4.0] {
        let found = place(&cubic, time).x;
        assert!((f64::from(found) - time * time * time).abs() < 1e-4, "{time}: {found}");
    }
}

#[test]
fn rotations_take_the_shorter_way() {
    let turn = |degrees: f64, sign: f64| {
        let half = degrees.to_radians() / 2.0;
        [0.0, half.sin() * sign, 0.0, half.cos() * sign]
    };
    let keys = [turn(0.0, 1.0), turn(90.0, -1.0), turn(170.0, 1.0)].concat();
    let model = animated("rotation", "VEC4", "LINEAR", &keys);
    for (time, degrees) in [(1.0, 0.0), (1.5, 45.0), (2.0, 90.0), (3.0, 130.0), (4.0, 170.0f32)] {
        let (_, rotation, _) = model.pose(Some(0), time)[0].to_scale_rotation_translation();
        let expected = Quat::from_rotation_y(degrees.to_radians());
        assert!(rotation.angle_between(expected) < 2e-3, "{time}: {rotation} {expected}");
    }
    let scaled = animated("scale", "VEC3", "LINEAR", &[1.0, 1.0, 1.0, 3.0, 1.0, 1.0, 3.0, 1.0, 1.0]);
    assert!(scaled.pose(Some(0), 1.5)[0].abs_diff_eq(Mat4::from_scale(Vec3::new(2.0, 1.0, 1.0)), 1e-6));
}

#[test]
fn nodes_that_turn_inside_out_are_told() {
    let turning = |keys: &[f64]| animated("scale", "VEC3", "LINEAR", keys).turning(Some(0));
    let one = [1.0, 1.0, 1.0];
    assert_eq!(turning(&[one, [1.0, -1.0, 1.0], one].concat()), [true]);
    assert_eq!(turning(&[[0.0; 3], [1.0, -1.0, 1.0], [1.0, -1.0, 1.0]].concat()), [true]);
    for (start, end) in [([0.0; 3], one), ([1.0, -1.0, 1.0], [2.0, -3.0, 1.0])] {
        assert_eq!(turning(&[start, end, end].concat()), [false], "{start:?}");
    }
    let mut builder = Builder::triangle();
    builder.document["nodes"] = json!([{"children": [1]}, {"mesh": 0}, {"mesh": 0}]);
    builder.document["scenes"][0]["nodes"] = json!([0, 2]);
    let input = builder.accessor("SCALAR", F32, &[0.0, 1.0]);
    let output = builder.accessor("VEC3", F32, &[1.0, 1.0, 1.0, 1.0, 1.0, -1.0]);
    builder.push(
        "animations",
        json!({"channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}],
               "samplers": [{"input": input, "output": output}]}),
    );
    let found = model(&builder);
    let (with_mesh, moved): (Vec<bool>, Vec<bool>) =
        found.nodes.iter().zip(found.turning(Some(0))).map(|(node, turns)| (node.parent.is_some(), turns)).unzip();
    assert_eq!(moved.iter().filter(|turns| **turns).count(), 2, "{with_mesh:?} {moved:?}");
    assert!(with_mesh.iter().zip(&moved).all(|(is_child, turns)| !is_child || *turns));
    assert_eq!(found.turning(None), [false; 3]);
}

#[test]
fn a_box_is_exact_until_it_would_cost_too_much() {
    // A triangle turned by 45 degrees about z: its own box is 1 x 1, and that of its box is wider.
    let (s, turn) = (0.5f64.sqrt(), 22.5f64.to_radians());
    let mut builder = Builder::triangle();
    builder.document["nodes"] =
        json!([{"mesh": 0, "rotation": [0, 0, (2.0 * turn / 2.0).sin(), (2.0 * turn / 2.0).cos()]}]);
    let one = model(&builder);
    let bounds = |model: &Model| model.bounds(&model.pose(None, 0.0)).unwrap();
    let near = |found: Vec3, expected: [f64; 3]| found.as_dvec3().abs_diff_eq(expected.into(), 1e-6);
    let exact = bounds(&one);
    assert!(near(exact.min, [-s, 0.0, 0.0]) && near(exact.max, [s, s, 0.0]), "{exact:?}");
    let mut many = one;
    let points = &mut many.meshes[0].primitives[0].positions;
    *points = points.iter().copied().cycle().take(9_000_000).collect();
    many.nodes.push(many.nodes[0].clone());
    let rough = bounds(&many);
    assert!(near(rough.min, [-s, 0.0, 0.0]) && near(rough.max, [s, 2.0 * s, 0.0]), "{rough:?}");
}
