//! What a graph file says, as written: names are not resolved, expressions are not evaluated,
//! defaults that depend on shaders are not filled in.

mod raster;

use std::path::PathBuf;
use std::sync::Arc;

use super::expr::Expr;
use super::rows::Row;
use super::value::Value;
use crate::diagnostic::{FileId, Span};
use crate::format::TextureFormat;

pub use crate::syntax::Sp;
pub use raster::*;

/// A name or a dotted path as written.
pub type Name = Sp<String>;

/// One graph file.
#[derive(Clone, Debug)]
pub struct Graph {
    pub path: PathBuf,
    pub file: FileId,
    /// The word `Graph` and its opening bracket, for labels about the whole file.
    pub span: Span,
    pub about: Option<String>,
    pub inputs: Vec<Input>,
    pub params: Vec<Param>,
    pub lets: Vec<Let>,
    /// `resources:` and `state:`, in the order of the file.
    pub resources: Vec<Resource>,
    pub samplers: Vec<Sampler>,
    pub passes: Vec<Node>,
    pub outputs: Vec<Output>,
    pub stats: Vec<Stat>,
}

/// A number over what a frame left in buffers.
#[derive(Clone, Debug)]
pub struct Stat {
    pub name: Name,
    /// As written.
    pub text: String,
    pub expr: Expr,
}

#[derive(Clone, Debug)]
pub struct Input {
    pub name: Name,
    pub kind: InputKind,
    pub optional: bool,
    /// What feeds it where a scene does not.
    pub default: Option<InputDefault>,
    pub span: Span,
}

/// What feeds an input that nothing else does.
#[derive(Clone, Debug, PartialEq)]
pub enum InputDefault {
    Light {
        direction: [f64; 3],
        color: [f64; 3],
        intensity: f64,
    },
    /// One texel, linear.
    Texture([f64; 4]),
    /// No particles.
    NoParticles,
    Table(Vec<Row>),
}

#[derive(Clone, Debug)]
pub enum InputKind {
    Camera,
    Light,
    /// Where a person points, in world space.
    Pointer,
    Particles {
        attributes: Arc<[Attribute]>,
    },
    /// Rows from the scene, packed by the reflected struct.
    Table,
    /// A texture; the dimension, if said, is checked against what is bound.
    Texture {
        dimension: Option<Sp<ViewDimension>>,
    },
    Buffer,
    Counted,
    /// Bodies with triangles and materials, and values that each body has.
    Meshes {
        values: Arc<[Param]>,
    },
}

impl InputKind {
    /// What the language calls it.
    pub fn name(&self) -> &'static str {
        match self {
            InputKind::Camera => "Camera",
            InputKind::Light => "Light",
            InputKind::Pointer => "Pointer",
            InputKind::Particles { .. } => "Particles",
            InputKind::Table => "Table",
            InputKind::Texture { .. } => "Texture",
            InputKind::Buffer => "Buffer",
            InputKind::Counted => "Counted",
            InputKind::Meshes { .. } => "Meshes",
        }
    }
}

/// What every input of meshes has, so that no value of its bodies can be called so.
pub const MESH_FIELDS: &[&str] = &[
    "bodies",
    "instances",
    "positions",
    "normals",
    "tangents",
    "uv0",
    "uv1",
    "color0",
    "triangles",
    "material",
    "count",
    "blended",
    "min",
    "max",
];

/// An attribute that a graph wants of its particles; `"color?"` is optional.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    pub name: Name,
    pub optional: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ViewDimension {
    D2,
    D2Array,
    Cube,
    CubeArray,
    D3,
}

#[derive(Clone, Debug)]
pub struct Param {
    pub name: Name,
    pub kind: ParamKind,
    /// Absent only in parts, whose user must then give it.
    pub default: Option<Sp<Value>>,
    /// For vectors and colours the bounds hold for each component.
    pub min: Option<Sp<Value>>,
    pub max: Option<Sp<Value>>,
    pub unit: Option<String>,
    pub about: Option<String>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub enum ParamKind {
    Int,
    Float,
    Bool,
    Choice(Vec<Name>),
    Vec2,
    Vec3,
    Vec4,
    /// Linear, unbounded; 3 or 4 components.
    Color,
}

impl ParamKind {
    pub fn name(&self) -> &'static str {
        match self {
            ParamKind::Int => "Int",
            ParamKind::Float => "Float",
            ParamKind::Bool => "Bool",
            ParamKind::Choice(_) => "Choice",
            ParamKind::Vec2 => "Vec2",
            ParamKind::Vec3 => "Vec3",
            ParamKind::Vec4 => "Vec4",
            ParamKind::Color => "Color",
        }
    }
}

#[derive(Clone, Debug)]
pub struct Let {
    pub name: Name,
    pub expr: Expr,
}

#[derive(Clone, Debug)]
pub struct Resource {
    pub name: Name,
    /// Declared under `state:`.
    pub state: bool,
    pub kind: ResourceKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a few of a graph, and never one of a frame")]
pub enum ResourceKind {
    Texture {
        format: Sp<TextureFormat>,
        /// One expression (a vector, or an edge length for a square), or one for each axis.
        size: Vec<Expr>,
        /// `D2`, `Cube` (six layers) or `D3`; array layers make no difference here.
        dimension: ViewDimension,
        layers: Option<Expr>,
        mips: Option<Mips>,
        samples: Option<Expr>,
    },
    Buffer {
        items: Expr,
    },
    Counted {
        capacity: Expr,
        /// What to warn of when nothing was appended in a whole frame.
        empty: Option<String>,
    },
    /// The same description as another texture or buffer.
    Like(Name),
}

#[derive(Clone, Debug)]
pub enum Mips {
    /// All levels, made by the planner.
    Auto(Span),
    /// So many levels, written by the author through views.
    Count(Expr),
}

#[derive(Clone, Debug)]
pub struct Sampler {
    pub name: Name,
    pub linear: bool,
    pub mip_linear: bool,
    pub address: Address,
    pub compare: Option<Compare>,
    pub anisotropy: u16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Address {
    Clamp,
    Repeat,
    Mirror,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Compare {
    Never,
    Less,
    Equal,
    LessEqual,
    Greater,
    NotEqual,
    GreaterEqual,
    Always,
}

/// An output: the thing and the name that users of the graph know it by.
#[derive(Clone, Debug)]
pub struct Output {
    pub name: Name,
    pub of: Name,
}

/// An entry of `passes:`.
#[derive(Clone, Debug)]
pub struct Node {
    pub kind: NodeKind,
    /// The whole entry.
    pub span: Span,
    /// Its first word, for labels.
    pub word: Span,
}

#[derive(Clone, Debug)]
pub enum NodeKind {
    Compute(Compute),
    Draw(Draw),
    /// A `Draw` without geometry.
    Fullscreen(Draw),
    Copy(Copy),
    Clear(Clear),
    Use(Use),
    Repeat(Repeat),
    If(If),
    Steps(Steps),
}

/// What a shader's variable, a uniform member or an override gets.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a few of a graph, and never one of a frame")]
pub enum Bound {
    /// A name of a thing, or an expression.
    Expr(Expr),
    View(View),
}

/// A part of a texture; what is not said is whole.
#[derive(Clone, Debug)]
pub struct View {
    pub of: Name,
    pub mip: Option<Expr>,
    pub layer: Option<Expr>,
    pub span: Span,
}

/// `"x.wgsl"` or `"x.wgsl#entry"` or `"x.wgsl#vertex,fragment"`.
#[derive(Clone, Debug)]
pub struct ShaderRef {
    pub path: Name,
    pub entries: Vec<Name>,
}

#[derive(Clone, Debug)]
pub struct Compute {
    pub name: Option<Name>,
    pub shader: ShaderRef,
    pub bind: Vec<(Name, Bound)>,
    pub extent: Extent,
}

/// How many threads or workgroups.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a few of a graph, and never one of a frame")]
pub enum Extent {
    /// Threads over the texels of a view.
    Texel(View),
    /// Threads over the items of a buffer, or the count of a counted one.
    Item(Name),
    Threads(Vec<Expr>),
    Groups(Vec<Expr>),
    /// One workgroup for each item.
    GroupsEach(Name),
}

#[derive(Clone, Debug)]
pub enum Count {
    Expr(Expr),
    Each(Name),
}

#[derive(Clone, Debug)]
pub struct Draw {
    pub name: Option<Name>,
    pub shader: ShaderRef,
    pub bind: Vec<(Name, Bound)>,
    pub vertices: Option<Count>,
    pub instances: Option<Count>,
    pub indices: Option<Name>,
    pub indirect: Option<Indirect>,
    pub meshes: Option<Name>,
    /// Of `meshes`: only bodies with one of these; absent: all.
    pub tags: Option<Vec<Name>>,
    /// Of `meshes`: only what blends, or only what does not; absent: all.
    pub only: Option<Covering>,
    pub topology: Topology,
    pub cull: Option<Face>,
    pub front_ccw: bool,
    pub color: Vec<Target>,
    pub depth: Option<Depth>,
    pub samples: Option<Expr>,
    /// x, y, width, height in pixels: viewport and scissor.
    pub region: Option<Sp<Vec<Expr>>>,
}

/// How materials cover what is behind them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Covering {
    /// Wholly, or by cut out parts.
    Opaque,
    Blended,
}

#[derive(Clone, Debug)]
pub struct Indirect {
    pub buffer: Name,
    pub item: Option<Expr>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Copy {
    pub name: Option<Name>,
    pub from: View,
    pub to: View,
}

#[derive(Clone, Debug)]
pub struct Clear {
    pub name: Option<Name>,
    pub of: View,
    /// 1 expression for all channels, or 4; default 0.
    pub value: Vec<Expr>,
}

#[derive(Clone, Debug)]
pub struct Use {
    pub graph: Name,
    pub name: Name,
    pub bind: Vec<(Name, Name)>,
    pub params: Vec<(Name, Expr)>,
}

#[derive(Clone, Debug)]
pub struct Repeat {
    pub times: Expr,
    pub index: Option<Name>,
    pub swap: Vec<Sp<Vec<Name>>>,
    pub passes: Vec<Node>,
}

#[derive(Clone, Debug)]
pub struct If {
    pub test: Expr,
    pub then: Vec<Node>,
    pub otherwise: Vec<Node>,
}

#[derive(Clone, Debug)]
pub struct Steps {
    pub name: Option<Name>,
    /// Hz; absent: once a frame.
    pub rate: Option<Expr>,
    /// All state of the steps starts anew when its value changes.
    pub key: Option<Expr>,
    pub passes: Vec<Node>,
}
