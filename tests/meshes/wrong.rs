//! What is said about files that are wrong: the whole texts stand in `tests/meshes/wrong.txt`.

use std::fmt::Write as _;

use meniscus::files::MemoryFiles;
use serde_json::{Value, json};

use super::build::{Builder, F32, U8, U16, bytes, png};
use super::surface::{ply, vtk};
use super::{golden, read, said};

/// The findings about each of many files.
#[derive(Default)]
struct Sheet(String);

impl Sheet {
    fn files(&mut self, title: &str, files: &MemoryFiles, path: &str) {
        let (word, found) = match read(files, path) {
            Ok(model) => ("read", model.diagnostics),
            Err(found) => ("refused", found),
        };
        let found = said(&found, path);
        assert!(!found.is_empty(), "{title}: nothing is said");
        _ = writeln!(self.0, "{title}: {word}\n{found}");
    }

    /// A triangle with a change.
    fn changed(&mut self, title: &str, change: impl FnOnce(&mut Builder)) {
        let mut builder = Builder::triangle();
        change(&mut builder);
        self.files(title, &builder.files().with("a.png", png(&[[0; 4]])), "a.gltf");
    }

    fn set(&mut self, title: &str, pointer: &str, value: Value) {
        self.changed(title, |builder| *builder.document.pointer_mut(pointer).unwrap() = value);
    }

    fn raw(&mut self, title: &str, name: &str, content: impl AsRef<[u8]>) {
        self.files(title, &MemoryFiles::default().with(name, content), name);
    }
}

fn obj(sheet: &mut Sheet, title: &str, more: &str) {
    sheet.raw(title, "a.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{more}\n"));
}

fn with_texture(builder: &mut Builder, image: Value) {
    builder.push("images", image);
    builder.push("textures", json!({"source": 0}));
    builder.push("materials", json!({"name": "skin", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    builder.primitive()["material"] = json!(0);
}

#[test]
fn every_message_is_as_it_is_written_down() {
    let mut sheet = Sheet::default();
    names_and_forms(&mut sheet);
    documents(&mut sheet);
    buffers(&mut sheet);
    attributes(&mut sheet);
    nodes(&mut sheet);
    materials(&mut sheet);
    animations(&mut sheet);
    objs(&mut sheet);
    surfaces(&mut sheet);
    golden::golden("tests/meshes/wrong.txt", &sheet.0);
}

fn surfaces(sheet: &mut Sheet) {
    sheet.raw("particles and no surface", "a.vtk", vtk("POLYDATA", "VERTICES 1 2\n1 0\n"));
    sheet.raw("a polygon of points that are not there", "a.vtk", vtk("POLYDATA", "POLYGONS 1 4\n3 1 2 5\n"));
    sheet.raw("a polygon of negative points", "a.vtk", vtk("POLYDATA", "POLYGONS 1 4\n3 1 2 -1\n"));
    sheet.raw("a polygon that goes beyond its list", "a.vtk", vtk("POLYDATA", "POLYGONS 1 4\n4 1 2 3\n"));
    let offsets = |o: &str| format!("POLYGONS 2 3\nOFFSETS vtktypeint64\n{o}\nCONNECTIVITY vtktypeint64\n1 2 3\n");
    sheet.raw("an offset beyond the corners", "a.vtk", vtk("POLYDATA", &offsets("0 4")));
    sheet.raw("solids", "a.vtk", vtk("UNSTRUCTURED_GRID", "CELLS 1 5\n4 1 2 3 4\nCELL_TYPES 1\n10\n"));
    sheet.raw("another dataset", "a.vtk", vtk("STRUCTURED_POINTS", ""));
    let rows = "0 0 0 1 1 1\n".repeat(5);
    let faces =
        |list: &str| format!("element face 1\nproperty list uchar int vertex_index\nend_header\n{rows}{list}\n");
    sheet.raw("faces without vertices", "a.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n");
    sheet.raw("a face of points that are not there", "a.ply", ply("ascii", &faces("3 0 1 9")));
    sheet.raw("a face that is cut short", "a.ply", ply("ascii", &faces("3 0 1")));
    sheet.raw("a face of a length that is none", "a.ply", ply("ascii", &faces("x")));
    sheet.raw(
        "points that are not finite",
        "a.ply",
        ply("ascii", &faces("3 0 1 2")).replacen("0 0 0 1", "nan 0 0 1", 1),
    );
}

fn names_and_forms(sheet: &mut Sheet) {
    sheet.raw("an unknown name", "a.fbx", b"x");
    sheet.raw("an empty file", "a.glb", b"");
    sheet.raw("no JSON", "a.gltf", b"hello");
    sheet.raw("JSON cut short", "a.gltf", b"{\"asset\": {\"version\":");
    let glb = Builder::triangle().glb();
    for end in [6, 15, 30, glb.len() - 1] {
        sheet.raw(&format!("a binary file cut after {end} bytes"), "a.glb", &glb[..end]);
    }
    let with = |at: usize, byte: u8| {
        let mut bytes = glb.clone();
        bytes[at] = byte;
        bytes
    };
    sheet.raw("another version of the binary form", "a.glb", with(4, 1));
    sheet.raw("a chunk that is too long", "a.glb", with(14, 200));
    sheet.raw("a first chunk that is not JSON", "a.glb", with(16, b'X'));
}

fn documents(sheet: &mut Sheet) {
    sheet.raw("no asset", "a.gltf", b"{}");
    sheet.set("an old version", "/asset/version", json!("1.0"));
    sheet.set("a version to come", "/asset", json!({"version": "2.0", "minVersion": "3.0"}));
    sheet.set("a wrong type", "/nodes", json!([{"mesh": "0"}]));
    sheet.set("a negative index", "/nodes", json!([{"mesh": -1}]));
    sheet.set("a list that is an object", "/meshes", json!({}));
    sheet.set("a word that is none of the choices", "/scenes", json!([{"nodes": 0}]));
    sheet.changed("a required extension that is not known", |b| {
        b.document["extensionsRequired"] = json!(["KHR_draco_mesh_compression", "KHR_texture_basisu"]);
    });
    sheet.changed("used extensions that are not known", |b| {
        b.document["extensionsUsed"] = json!(["KHR_materials_sheen", "KHR_materials_unlit"]);
    });
}

fn buffers(sheet: &mut Sheet) {
    sheet.set("a buffer that is not there", "/buffers/0/uri", json!("gone.bin"));
    sheet.set("a buffer outside of the folder", "/buffers/0/uri", json!("../secret.bin"));
    sheet.set("a buffer by its whole path", "/buffers/0/uri", json!("/etc/passwd"));
    sheet.set("a buffer of the net", "/buffers/0/uri", json!("https://example.org/a.bin"));
    sheet.set("a buffer without content", "/buffers/0", json!({"byteLength": 4}));
    sheet.set("a buffer that is too short", "/buffers/0/byteLength", json!(1000));
    sheet.set("data that are no base64", "/buffers/0/uri", json!("data:x;base64,@@@@"));
    sheet.set("data without a comma", "/buffers/0/uri", json!("data:xyz"));
    sheet.set("a view beyond its buffer", "/bufferViews/0/byteLength", json!(37));
    sheet.set("a view of a huge length", "/bufferViews/0/byteLength", json!(u64::MAX));
    sheet.set("a view of a buffer that is not there", "/bufferViews/0/buffer", json!(3));
    sheet.set("an accessor beyond its view", "/accessors/0/count", json!(4));
    sheet.set("an accessor of a huge count", "/accessors/0/count", json!(u64::MAX));
    sheet.set("an accessor of a view that is not there", "/accessors/0/bufferView", json!(3));
    sheet.set("a component type of nothing", "/accessors/0/componentType", json!(5124));
    sheet.set("another shape", "/accessors/0/type", json!("VEC2"));
    sheet.changed("a stride that is too small", |b| b.document["bufferViews"][0]["byteStride"] = json!(4));
    sheet.changed("zeros without end", |b| {
        b.document["accessors"][0] = json!({"componentType": F32, "count": 1_u64 << 40, "type": "VEC3"});
    });
    sheet.changed("sparse indices that are out of order", |b| {
        let places = b.view(&bytes(U16, &[2.0, 1.0]));
        let values = b.view(&bytes(F32, &[0.0; 6]));
        b.document["accessors"][0]["sparse"] = json!({"count": 2,
            "indices": {"bufferView": places, "componentType": U16}, "values": {"bufferView": values}});
    });
    sheet.changed("sparse values that are too few", |b| {
        let places = b.view(&bytes(U16, &[1.0, 2.0]));
        let values = b.view(&bytes(F32, &[0.0; 5]));
        b.document["accessors"][0]["sparse"] = json!({"count": 2,
            "indices": {"bufferView": places, "componentType": U16}, "values": {"bufferView": values}});
    });
}

fn attributes(sheet: &mut Sheet) {
    sheet.set("no positions", "/meshes/0/primitives/0/attributes", json!({"NORMAL": 0}));
    sheet.set("an accessor that is not there", "/meshes/0/primitives/0/attributes/POSITION", json!(9));
    sheet.changed("lines", |b| b.primitive()["mode"] = json!(1));
    sheet.changed("a mode of nothing", |b| b.primitive()["mode"] = json!(9));
    sheet.changed("an index out of range", |b| _ = b.indices(U16, &[0.0, 1.0, 3.0]));
    sheet.changed("fractional indices", |b| _ = b.indices(F32, &[0.0, 1.0, 2.0]));
    sheet.changed("indices left over", |b| _ = b.indices(U8, &[0.0, 1.0, 2.0, 0.0]));
    sheet.changed("too few indices", |b| _ = b.indices(U8, &[0.0, 1.0]));
    sheet.changed("too few normals", |b| _ = b.attribute("NORMAL", "VEC3", F32, &[0.0, 0.0, 1.0]));
    sheet.changed("positions that are not finite", |b| b.binary[16..20].copy_from_slice(&f32::NAN.to_le_bytes()));
    let bad = [0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0, 0.0, 0.0, 1.0];
    sheet.changed("zero and infinite normals", |b| _ = b.attribute("NORMAL", "VEC3", F32, &bad));
    sheet.changed("tangents without a direction", |b| {
        b.attribute("NORMAL", "VEC3", F32, &[0.0, 0.0, 1.0].repeat(3));
        b.attribute("TANGENT", "VEC4", F32, &[0.0; 12]);
    });
    sheet.changed("texture coordinates that are not finite", |b| {
        b.attribute("TEXCOORD_0", "VEC2", F32, &[f64::NAN, 0.0, 0.0, 0.0, 0.0, f64::INFINITY]);
    });
    sheet.changed("morph targets", |b| b.primitive()["targets"] = json!([{"POSITION": 0}]));
    sheet.changed("many that share one array", |b| {
        let many = vec![json!(0); 20_000];
        let zeros = json!({"componentType": F32, "count": 3000, "type": "VEC3", "sparse": {"count": 0,
            "indices": {"bufferView": 0, "componentType": U16}, "values": {"bufferView": 0}}});
        b.document["accessors"] = json!([zeros]);
        b.document["meshes"][0]["primitives"] =
            many.into_iter().map(|position| json!({"attributes": {"POSITION": position}})).collect();
    });
}

fn nodes(sheet: &mut Sheet) {
    sheet.set("a mesh that is not there", "/nodes", json!([{"mesh": 4}]));
    sheet.set("a scene that is not there", "/scene", json!(2));
    sheet.set("no root node", "/scenes", json!([{}]));
    sheet.set("a root that is not there", "/scenes", json!([{"nodes": [5]}]));
    sheet.set("a child that is not there", "/nodes", json!([{"name": "boat", "children": [7]}]));
    sheet.set("a node that is its own child", "/nodes", json!([{"children": [0]}]));
    sheet.set("a root that is a child", "/nodes", json!([{}, {"children": [0]}]));
    sheet.changed("a ring of nodes", |b| {
        b.document["nodes"] = json!([{"mesh": 0}, {"children": [2]}, {"children": [3]}, {"children": [1]}]);
    });
    sheet.set("two parents", "/nodes", json!([{"children": [2]}, {"children": [2]}, {"mesh": 0}]));
    sheet.set("a transform that is not finite", "/nodes", json!([{"mesh": 0, "translation": [1e39, 0, 0]}]));
    let huge = json!([{"children": [1]}, {"name": "far", "mesh": 0, "scale": [1e30, 1e30, 1e30], "children": [2]}, {"mesh": 0}]);
    sheet.changed("transforms whose product is not finite", |b| {
        b.document["nodes"] = huge;
        b.document["nodes"][0]["scale"] = json!([1e30, 1e30, 1e30]);
    });
    sheet.set(
        "a node that is too far away",
        "/nodes",
        json!([{"mesh": 0, "name": "far", "translation": [0, 0, 2e18]}]),
    );
    sheet.changed("many nodes that share a mesh of many primitives", |b| {
        b.document["scenes"][0]["nodes"] = (0..1000).collect();
        b.document["nodes"] = (0..1000).map(|_| json!({"mesh": 0})).collect();
        b.document["meshes"][0]["primitives"] = (0..1000).map(|_| json!({"attributes": {"POSITION": 0}})).collect();
    });
    sheet.changed("cameras that are none", |b| {
        b.push("cameras", json!({"name": "eye", "type": "perspective", "perspective": {"yfov": -3, "znear": 0.1}}));
        b.push("cameras", json!({"type": "perspective"}));
        b.push(
            "cameras",
            json!({"type": "orthographic", "orthographic": {"xmag": 0, "ymag": 1, "znear": 0, "zfar": 1}}),
        );
        b.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1, "zfar": 0.1}}));
    });
    let lamps = |b: &mut Builder| {
        let on = json!({"KHR_lights_punctual": {"light": 0}});
        b.document["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
        b.document["nodes"] = json!([{"mesh": 0, "children": [1], "extensions": on.clone()}, {"extensions": on}]);
    };
    sheet.changed("lights", lamps);
    sheet.changed("lights that are required", |b| {
        lamps(b);
        b.document["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    });
    sheet.set("a rotation of no length", "/nodes", json!([{"mesh": 0, "rotation": [0, 0, 0, 0]}]));
    sheet.set("a skin", "/nodes", json!([{"mesh": 0, "skin": 0}]));
    sheet.set("a camera that is not there", "/nodes", json!([{"mesh": 0, "camera": 0}]));
}

fn materials(sheet: &mut Sheet) {
    sheet.changed("a material that is not there", |b| b.primitive()["material"] = json!(1));
    sheet.changed("an image that is missing", |b| with_texture(b, json!({"uri": "gone.png"})));
    sheet.changed("an image outside of the folder", |b| with_texture(b, json!({"uri": "../../gone.png"})));
    sheet.changed("an image that is none", |b| with_texture(b, json!({"uri": "data.bin"})));
    sheet.changed("an image of nothing", |b| with_texture(b, json!({})));
    sheet.changed("an image in a view that is not there", |b| with_texture(b, json!({"bufferView": 8})));
    sheet.changed("a texture that is not there", |b| {
        b.push("materials", json!({"normalTexture": {"index": 3}}));
    });
    sheet.changed("a texture without an image", |b| {
        b.push("materials", json!({"emissiveTexture": {"index": 0}}));
        b.push("textures", json!({}));
    });
    sheet.changed("an image that is not there", |b| {
        b.push("materials", json!({"emissiveTexture": {"index": 0}}));
        b.push("textures", json!({"source": 1}));
    });
    sheet.changed("a sampler that is not there", |b| {
        with_texture(b, json!({"uri": "a.png"}));
        b.document["textures"][0]["sampler"] = json!(0);
    });
    sheet.changed("a sampler of unknown filters", |b| {
        with_texture(b, json!({"uri": "a.png"}));
        b.push("samplers", json!({"magFilter": 1, "minFilter": 2, "wrapS": 3, "wrapT": 4}));
        b.document["textures"][0]["sampler"] = json!(0);
    });
    sheet.changed("a third set of texture coordinates", |b| {
        with_texture(b, json!({"uri": "a.png"}));
        b.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(2);
    });
    sheet.changed("a material that lets light through", |b| {
        let glass = json!({"KHR_materials_transmission": {"transmissionFactor": 1}});
        b.push("materials", json!({"name": "glass", "extensions": glass}));
    });
    sheet.changed("factors out of range", |b| {
        b.push("materials", json!({"pbrMetallicRoughness": {"metallicFactor": 3, "roughnessFactor": -1}}));
    });
}

fn animated(builder: &mut Builder, times: &[f64], path: &str, node: usize) {
    let input = builder.accessor("SCALAR", F32, times);
    let output = builder.accessor("VEC3", F32, &vec![0.0; times.len() * 3]);
    builder.push(
        "animations",
        json!({"channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
               "samplers": [{"input": input, "output": output}]}),
    );
}

fn animations(sheet: &mut Sheet) {
    sheet.changed("times that fall", |b| animated(b, &[0.0, 2.0, 1.0], "translation", 0));
    sheet.changed("times that are not finite", |b| animated(b, &[0.0, f64::NAN], "scale", 0));
    sheet.changed("no times", |b| animated(b, &[], "scale", 0));
    sheet.changed("a path of nothing", |b| animated(b, &[0.0], "colour", 0));
    sheet.changed("weights of morph targets", |b| animated(b, &[0.0], "weights", 0));
    sheet.changed("what is no node", |b| {
        animated(b, &[0.0], "pointer", 0);
        b.document["animations"][0]["channels"][0]["target"] = json!({"path": "pointer"});
    });
    sheet.changed("a node that is not there", |b| animated(b, &[0.0], "scale", 4));
    sheet.changed("rotations of three numbers", |b| animated(b, &[0.0], "rotation", 0));
    sheet.changed("a sampler of an animation that is not there", |b| {
        animated(b, &[0.0], "scale", 0);
        b.document["animations"][0]["channels"][0]["sampler"] = json!(1);
    });
    sheet.changed("values that are too few", |b| {
        animated(b, &[0.0, 1.0], "scale", 0);
        b.document["accessors"][2]["count"] = json!(1);
    });
    sheet.changed("a node with a matrix", |b| {
        animated(b, &[0.0], "scale", 0);
        b.document["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    });
}

fn objs(sheet: &mut Sheet) {
    sheet.raw("no faces", "a.obj", "v 0 0 0\n");
    sheet.raw("no text", "a.obj", [0xff, 0xfe, 0, 1, 2]);
    obj(sheet, "an index of 0", "f 0 1 2");
    obj(sheet, "an index that is too large", "f 1 2 4\nf 1 2 3");
    obj(sheet, "an index that goes too far back", "f -1 -2 -4");
    obj(sheet, "a huge index", "f 1 2 99999999999999999999\nf 1 2 9999999999");
    obj(sheet, "no index", "f 1 2 x");
    obj(sheet, "a corner without a vertex", "f 1 2 /3");
    obj(sheet, "a corner of four parts", "f 1 2 3/1/1/1");
    obj(sheet, "texture coordinates and normals out of range", "vt 0 0\nvn 0 0 1\nf 1/2 2/1 3/1\nf 1//1 2//2 3//1");
    obj(sheet, "faces of one and of two corners", "f 1 2\nf 1\nf\nf 1 2 3");
    obj(sheet, "a number that is none", "v 1 2 three");
    obj(sheet, "numbers that are too few", "v 1 2\nvn 1");
    obj(sheet, "a number that is not finite", "v 1 2 inf\nv 1e99 0 0");
    obj(sheet, "a vertex that is too far away", "v 3e38 0 0\nf 1 2 4");
    obj(sheet, "normals of no length", "vn 0 0 0\nf 1//1 2//1 3//1");
    let many: String = (0..100).map(|k| format!("f 1 2 {}\n", k + 4)).collect();
    obj(sheet, "the same fault a hundred times", &many);
    obj(sheet, "materials that are not there", "mtllib gone.mtl\nusemtl red\nf 1 2 3");
    obj(sheet, "materials outside of the folder", "mtllib ../a.mtl\nf 1 2 3");
    obj(sheet, "several files of materials that are not there", "mtllib ../x.mtl my own.MTL\nf 1 2 3");
    let beside = MemoryFiles::default()
        .with("a.obj", "mtllib C:\\work\\a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
        .with("a.mtl", "newmtl red\nmap_Kd C:\\Users\\me\\grey.png\nmap_Pr /home/me/gone.png\n")
        .with("grey.png", png(&[[7; 4]]));
    sheet.files("whole paths of another computer", &beside, "a.obj");
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    let mtl = |text: &str| format!("# colours\n{text}");
    let cases = [
        ("a name that is misspelt", "newmtl Red\nKd 1 0 0\n"),
        ("a colour that is none", "newmtl red\nKd red\n"),
        ("a colour by its spectrum", "newmtl red\nKd spectral a.rfl\n"),
        ("a picture that is missing", "newmtl red\nmap_Kd gone.png\n"),
        ("a picture of the net", "newmtl red\nmap_Kd http://example.org/a.png\n"),
        ("a map of heights", "newmtl red\nbump grey.png\n"),
        (
            "maps without a place",
            "newmtl red\nmap_Ks grey.png\nKS 1 1 1\nmap_ks grey.png\nrefl -type sphere grey.png\n",
        ),
        ("words that are none of MTL", "newmtl red\nKq 1\nkq 2\nmap_Foo x\n# Kz\nx\ny\nz\n"),
        ("two pictures of unlike size", "newmtl red\nmap_Pr grey.png\nmap_Pm wide.png\n"),
    ];
    for (title, content) in cases {
        let files = MemoryFiles::default()
            .with("a.obj", text)
            .with("a.mtl", mtl(content))
            .with("grey.png", png(&[[7; 4]]))
            .with("wide.png", png(&[[7; 4]; 3]));
        sheet.files(title, &files, "a.obj");
    }
}
