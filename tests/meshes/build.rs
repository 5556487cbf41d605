//! Small glTF files in memory.

use meniscus::files::MemoryFiles;
use serde_json::{Value, json};

/// A document whose buffer grows with what is put into it.
pub struct Builder {
    pub document: Value,
    pub binary: Vec<u8>,
}

pub const U8: u32 = 5121;
pub const I8: u32 = 5120;
pub const U16: u32 = 5123;
pub const I16: u32 = 5122;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// The bytes of numbers of a component type.
pub fn bytes(kind: u32, numbers: &[f64]) -> Vec<u8> {
    let of = |x: &f64| match kind {
        U8 => vec![*x as u8],
        I8 => vec![*x as i8 as u8],
        U16 => (*x as u16).to_le_bytes().to_vec(),
        I16 => (*x as i16).to_le_bytes().to_vec(),
        U32 => (*x as u32).to_le_bytes().to_vec(),
        _ => (*x as f32).to_le_bytes().to_vec(),
    };
    numbers.iter().flat_map(of).collect()
}

impl Builder {
    pub fn new() -> Self {
        let document = json!({
            "asset": {"version": "2.0"},
            "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {}}]}],
            "accessors": [], "bufferViews": [], "buffers": [{"byteLength": 0, "uri": "data.bin"}],
        });
        Self { document, binary: Vec::new() }
    }

    /// A triangle of the plane z = 0 in the first mesh.
    pub fn triangle() -> Self {
        let mut builder = Self::new();
        builder.attribute("POSITION", "VEC3", F32, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        builder
    }

    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.document[list].is_null() {
            self.document[list] = json!([]);
        }
        let list = self.document[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub fn view(&mut self, content: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let start = self.binary.len();
        self.binary.extend(content);
        self.document["buffers"][0]["byteLength"] = json!(self.binary.len());
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": start, "byteLength": content.len()}))
    }

    pub fn accessor(&mut self, shape: &str, kind: u32, numbers: &[f64]) -> usize {
        let view = self.view(&bytes(kind, numbers));
        let count = numbers.len() / width(shape);
        self.push("accessors", json!({"bufferView": view, "componentType": kind, "count": count, "type": shape}))
    }

    pub fn primitive(&mut self) -> &mut Value {
        &mut self.document["meshes"][0]["primitives"][0]
    }

    pub fn attribute(&mut self, name: &str, shape: &str, kind: u32, numbers: &[f64]) -> usize {
        let accessor = self.accessor(shape, kind, numbers);
        self.primitive()["attributes"][name] = json!(accessor);
        accessor
    }

    pub fn indices(&mut self, kind: u32, numbers: &[f64]) -> usize {
        let accessor = self.accessor("SCALAR", kind, numbers);
        self.primitive()["indices"] = json!(accessor);
        accessor
    }

    /// `a.gltf` with its buffer beside it.
    pub fn files(&self) -> MemoryFiles {
        let text = serde_json::to_vec_pretty(&self.document).unwrap();
        MemoryFiles::default().with("a.gltf", text).with("data.bin", &self.binary)
    }

    /// The same in one file.
    pub fn glb(&self) -> Vec<u8> {
        let mut document = self.document.clone();
        document["buffers"][0].as_object_mut().unwrap().remove("uri");
        glb(&serde_json::to_vec(&document).unwrap(), &self.binary)
    }
}

pub fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    for (kind, chunk, fill) in [(b"JSON", json, b' '), (b"BIN\0", binary, 0)] {
        let mut chunk = chunk.to_vec();
        chunk.resize(chunk.len().next_multiple_of(4), fill);
        body.extend((chunk.len() as u32).to_le_bytes());
        body.extend(kind);
        body.extend(chunk);
    }
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((body.len() as u32 + 12).to_le_bytes());
    bytes.extend(body);
    bytes
}

fn width(shape: &str) -> usize {
    match shape {
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        _ => 1,
    }
}

/// A PNG of one row of texels.
pub fn png(texels: &[[u8; 4]]) -> Vec<u8> {
    use image::ImageEncoder;
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(texels.as_flattened(), texels.len() as u32, 1, image::ExtendedColorType::Rgba8)
        .unwrap();
    bytes
}
