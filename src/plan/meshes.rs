//! What planning knows of meshes (rule 29): the buffers of an input, what its vertices and materials
//! have by name, and the draws that show it. Plain data; the host fills the buffers.

use std::collections::BTreeMap;

use super::model::ObjectRef;
use crate::diagnostic::Span;
use crate::graph::value::Value;
use crate::shader::reflect::{Member, Scalar, Type};

/// What feeds an input of meshes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshesInfo {
    pub bodies: u64,
    /// Primitives placed in bodies: items of `x.instances`.
    pub instances: u64,
    pub vertices: u64,
    pub triangles: u64,
    pub materials: u32,
    pub draws: Vec<MeshDraw>,
    /// Bounds in world space, in metres; zeros without bodies.
    pub min: [f64; 3],
    pub max: [f64; 3],
    /// Whether time moves any of it.
    pub animated: bool,
    /// Values by name: one for each body, absent where the scene gives none.
    pub values: BTreeMap<String, Vec<Option<Value>>>,
}

/// One call: a range of triangles, as often as it stands in one entry's bodies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshDraw {
    pub first_index: u32,
    pub indices: u32,
    /// Into `x.instances`.
    pub first_instance: u32,
    pub instances: u32,
    pub material: u32,
    pub faces: Faces,
    /// Drawn after all that is opaque.
    pub blended: bool,
    pub tags: Vec<String>,
}

/// Which sides of triangles are seen, and which way round they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Faces {
    /// Both sides show, whatever the pass culls.
    pub double_sided: bool,
    /// The transform mirrors: front is clockwise.
    pub mirrored: bool,
}

impl Faces {
    /// All there are, in the order of [`Faces::index`].
    pub const ALL: [Faces; 4] = [
        Faces { double_sided: false, mirrored: false },
        Faces { double_sided: true, mirrored: false },
        Faces { double_sided: false, mirrored: true },
        Faces { double_sided: true, mirrored: true },
    ];

    pub fn index(self) -> usize {
        usize::from(self.double_sided) + 2 * usize::from(self.mirrored)
    }
}

/// A buffer that an input of meshes has.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshBuffer {
    /// World from body, of each body.
    Bodies,
    Instances,
    /// An attribute of all vertices.
    Vertices(VertexAttribute),
    /// Three indices into the vertices for each triangle.
    Triangles,
    /// A value of each body; what the scene does not give is `default`.
    Value {
        name: String,
        default: Option<Value>,
    },
    /// Factors of each material, packed as a shader's `material` wants them.
    Materials,
}

/// An attribute of vertices, in WGSL a vertex input of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VertexAttribute {
    Position,
    Normal,
    Tangent,
    Uv0,
    Uv1,
    Color0,
    /// The index into `x.instances`, counted for each draw.
    Instance,
}

impl VertexAttribute {
    pub const ALL: [VertexAttribute; 7] = [
        VertexAttribute::Position,
        VertexAttribute::Normal,
        VertexAttribute::Tangent,
        VertexAttribute::Uv0,
        VertexAttribute::Uv1,
        VertexAttribute::Color0,
        VertexAttribute::Instance,
    ];

    /// The name of the vertex input.
    pub fn name(self) -> &'static str {
        match self {
            VertexAttribute::Position => "position",
            VertexAttribute::Normal => "normal",
            VertexAttribute::Tangent => "tangent",
            VertexAttribute::Uv0 => "uv0",
            VertexAttribute::Uv1 => "uv1",
            VertexAttribute::Color0 => "color0",
            VertexAttribute::Instance => "instance",
        }
    }

    /// Numbers of 32 bits in an item.
    pub fn components(self) -> u32 {
        match self {
            VertexAttribute::Position | VertexAttribute::Normal => 3,
            VertexAttribute::Tangent | VertexAttribute::Color0 => 4,
            VertexAttribute::Uv0 | VertexAttribute::Uv1 => 2,
            VertexAttribute::Instance => 1,
        }
    }

    /// The type of the vertex input.
    pub fn ty(self) -> Type {
        match self {
            VertexAttribute::Instance => Type::Scalar(Scalar::U32),
            other => Type::Vector { components: other.components(), scalar: Scalar::F32 },
        }
    }
}

impl MeshBuffer {
    /// The buffers that have names of their own, with those names.
    pub const NAMED: [(&'static str, MeshBuffer); 9] = [
        ("bodies", MeshBuffer::Bodies),
        ("instances", MeshBuffer::Instances),
        ("positions", MeshBuffer::Vertices(VertexAttribute::Position)),
        ("normals", MeshBuffer::Vertices(VertexAttribute::Normal)),
        ("tangents", MeshBuffer::Vertices(VertexAttribute::Tangent)),
        ("uv0", MeshBuffer::Vertices(VertexAttribute::Uv0)),
        ("uv1", MeshBuffer::Vertices(VertexAttribute::Uv1)),
        ("color0", MeshBuffer::Vertices(VertexAttribute::Color0)),
        ("triangles", MeshBuffer::Triangles),
    ];

    /// What follows the input's name and a dot.
    pub fn name(&self) -> &str {
        match self {
            MeshBuffer::Value { name, .. } => name,
            MeshBuffer::Materials => "material",
            other => MeshBuffer::NAMED.iter().find(|(_, buffer)| buffer == other).map_or("", |(name, _)| name),
        }
    }

    /// Bytes of an item, and what it is called in messages; absent where shaders decide.
    pub fn item(&self) -> Option<(u32, &'static str)> {
        match self {
            MeshBuffer::Bodies => Some((64, "`array<mat4x4<f32>>`")),
            MeshBuffer::Instances => Some((INSTANCE_BYTES, "`array<Instance>`, from \"lib/meshes.wgsl\"")),
            MeshBuffer::Triangles => Some((12, "`array<Triangle>`, from \"lib/meshes.wgsl\"")),
            MeshBuffer::Vertices(attribute) => Some((
                4 * attribute.components(),
                match attribute.components() {
                    2 => "`array<vec2<f32>>`",
                    3 => "`array<Packed3>`, from \"lib/packed.wgsl\"",
                    _ => "`array<vec4<f32>>`",
                },
            )),
            MeshBuffer::Value { .. } | MeshBuffer::Materials => None,
        }
    }

    /// Whether time changes what it holds, where it changes anything.
    pub fn moves(&self) -> bool {
        matches!(self, MeshBuffer::Instances)
    }

    /// How many items there are.
    pub fn items(&self, info: &MeshesInfo) -> u64 {
        match self {
            MeshBuffer::Bodies | MeshBuffer::Value { .. } => info.bodies,
            MeshBuffer::Instances => info.instances,
            MeshBuffer::Vertices(_) => info.vertices,
            MeshBuffer::Triangles => info.triangles,
            MeshBuffer::Materials => u64::from(info.materials),
        }
    }
}

/// Bytes of an item of `x.instances`: body from mesh, body, first triangle, triangles, material.
pub const INSTANCE_BYTES: u32 = 80;

/// Materials lie so far apart that each can be bound by itself on every device.
pub const MATERIAL_ALIGNMENT: u32 = 256;

/// A texture of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MaterialTexture {
    BaseColor,
    MetallicRoughness,
    Normal,
    Occlusion,
    Emissive,
}

impl MaterialTexture {
    pub const ALL: [MaterialTexture; 5] = [
        MaterialTexture::BaseColor,
        MaterialTexture::MetallicRoughness,
        MaterialTexture::Normal,
        MaterialTexture::Occlusion,
        MaterialTexture::Emissive,
    ];

    /// `base_color` of `base_color_texture`, `base_color_sampler` and so on.
    pub fn stem(self) -> &'static str {
        match self {
            MaterialTexture::BaseColor => "base_color",
            MaterialTexture::MetallicRoughness => "metallic_roughness",
            MaterialTexture::Normal => "normal",
            MaterialTexture::Occlusion => "occlusion",
            MaterialTexture::Emissive => "emissive",
        }
    }

    /// The texture that a WGSL name with this ending stands for.
    pub fn named(name: &str, ending: &str) -> Option<Self> {
        let stem = name.strip_suffix(ending)?;
        Self::ALL.into_iter().find(|texture| texture.stem() == stem)
    }
}

const fn vector(components: u32) -> Type {
    Type::Vector { components, scalar: Scalar::F32 }
}

const FLOAT: Type = Type::Scalar(Scalar::F32);
const WHOLE: Type = Type::Scalar(Scalar::U32);
const MAT3: Type = Type::Matrix { columns: 3, rows: 3, scalar: Scalar::F32 };

/// Factors of a material by glTF's names, with their WGSL types.
pub const MATERIAL: &[(&str, Type)] = &[
    ("base_color_factor", vector(4)),
    ("metallic_factor", FLOAT),
    ("roughness_factor", FLOAT),
    ("emissive_factor", vector(3)),
    ("emissive_strength", FLOAT),
    ("normal_scale", FLOAT),
    ("occlusion_strength", FLOAT),
    ("alpha_mode", WHOLE),
    ("alpha_cutoff", FLOAT),
    ("double_sided", WHOLE),
    ("unlit", WHOLE),
    ("ior", FLOAT),
    ("transmission_factor", FLOAT),
    ("base_color_texcoord", WHOLE),
    ("base_color_transform", MAT3),
    ("metallic_roughness_texcoord", WHOLE),
    ("metallic_roughness_transform", MAT3),
    ("normal_texcoord", WHOLE),
    ("normal_transform", MAT3),
    ("occlusion_texcoord", WHOLE),
    ("occlusion_transform", MAT3),
    ("emissive_texcoord", WHOLE),
    ("emissive_transform", MAT3),
];

/// Where a draw of meshes has its vertices from.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshGeometry {
    /// The root's input; empty where nothing feeds it.
    pub input: String,
    pub indices: ObjectRef,
    pub vertices: Vec<VertexBuffer>,
    pub draws: Vec<MeshDraw>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct VertexBuffer {
    pub location: u32,
    pub attribute: VertexAttribute,
    /// Absent for `instance`, which the engine counts.
    pub buffer: Option<ObjectRef>,
}

impl MeshGeometry {
    /// How many triangles are drawn in all.
    pub fn triangles(&self) -> u64 {
        self.draws.iter().map(|d| u64::from(d.indices / 3) * u64::from(d.instances)).sum()
    }
}

/// An item of `x.instances` as shaders must see it.
pub fn instance_type() -> Type {
    let span = Span { file: crate::diagnostic::FileId(0), start: 0, end: 0 };
    let member = |name: &str, offset, ty| Member { name: name.into(), offset, ty, span };
    let members = vec![
        member("body_from_mesh", 0, Type::Matrix { columns: 4, rows: 4, scalar: Scalar::F32 }),
        member("body", 64, WHOLE),
        member("first_triangle", 68, WHOLE),
        member("triangles", 72, WHOLE),
        member("material", 76, WHOLE),
    ];
    Type::Struct { name: "Instance".into(), members, size: INSTANCE_BYTES }
}

/// The scene that graphs are checked with: two bodies of two materials, of which one blends.
pub fn stand_in() -> MeshesInfo {
    let draw = |first_index, first_instance, material, faces, blended| MeshDraw {
        first_index,
        indices: 36,
        first_instance,
        instances: 1,
        material,
        faces,
        blended,
        tags: Vec::new(),
    };
    MeshesInfo {
        bodies: 2,
        instances: 2,
        vertices: 48,
        triangles: 24,
        materials: 2,
        draws: vec![
            draw(0, 0, 0, Faces::default(), false),
            draw(36, 1, 1, Faces { double_sided: true, mirrored: false }, true),
        ],
        min: [-1.0, 0.0, -1.0],
        max: [1.0, 1.0, 1.0],
        animated: true,
        values: BTreeMap::new(),
    }
}
