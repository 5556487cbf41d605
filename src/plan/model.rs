//! A plan: what happens in a frame, as plain data. The engine only carries it out.
//!
//! Every name is resolved, every size is a number, loops are unrolled, branches are taken. What
//! is left open is only what changes while frames run: time, cameras and lights (see
//! [`UniformValue::Live`]), and which memory a swapped state has (see [`ObjectRef::Ring`]).

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use wgpu_types::{BufferUsages, Features, TextureUsages};

pub use self::memory::*;
pub use self::pass::*;
pub use self::request::*;
pub use self::stat::*;
use crate::diagnostic::{Diagnostics, Span};
use crate::format::TextureFormat;
use crate::graph::expr::Expr;
use crate::graph::model::{ParamKind, Sampler};
use crate::graph::value::Value;
use crate::plan::meshes::MeshBuffer;
use crate::shader::reflect::{Module, Type};

mod memory;
mod pass;
mod request;
mod stat;

/// Index into [`Plan::objects`].
pub type ObjectId = usize;

#[derive(Clone, Debug)]
pub struct Plan {
    /// The graph file.
    pub graph: PathBuf,
    pub viewport: [u32; 2],
    /// Shader modules; passes refer to them by index.
    pub modules: Vec<Arc<Module>>,
    pub objects: Vec<Object>,
    /// Uniform blocks that the host packs; equal blocks are one.
    pub uniforms: Vec<UniformBlock>,
    pub samplers: Vec<Sampler>,
    /// Live passes in the order in which they run: that of the program, but for those that
    /// [`Plan::order`] says.
    pub passes: Vec<Pass>,
    /// Where that is not how the program has them.
    pub order: Order,
    pub culled: Vec<Culled>,
    pub units: Vec<Unit>,
    pub rings: Vec<Ring>,
    pub steps: Vec<Steps>,
    /// The first is the picture.
    pub outputs: Vec<Output>,
    /// Every resource's instance path and what it is after the last pass; for dumps and viewers.
    pub names: BTreeMap<String, ObjectRef>,
    pub memory: Memory,
    pub needs: Needs,
    /// In the order of the graphs that declare them. They have values only if somebody asked for them.
    pub stats: Vec<Stat>,
    /// Parameters under their instance paths, with the values that this plan was made for.
    pub params: Vec<Param>,
    /// Instance paths of those on which more hangs than what a uniform holds: sizes, counts, tests,
    /// constants.
    pub structural: BTreeSet<String>,
    /// Instance paths of those that stand in arithmetic.
    pub arithmetic: BTreeSet<String>,
    /// Each `graph:` or `shader:` as written, and the file that was taken.
    pub taken: BTreeMap<String, PathBuf>,
    /// Number of 32-byte slots for indirect arguments that the engine's kernels write.
    pub argument_slots: u32,
    pub warnings: Diagnostics,
}

impl Plan {
    /// What an input has to be: format, size and usages of a texture, bytes and usages of a buffer.
    /// `path` is the input's name, or `input.attribute` for particles. With the number of the
    /// object, under which a runner takes it.
    pub fn needs(&self, path: &str) -> Option<(ObjectId, &ObjectKind)> {
        let is_it = |object: &&Object| object.origin != Origin::Frame && object.path == path;
        let (id, object) = self.objects.iter().enumerate().find(|(_, object)| is_it(object))?;
        Some((id, &object.kind))
    }

    /// Inputs whose materials' textures passes bind, some more than once.
    pub(crate) fn materials(&self) -> impl Iterator<Item = &str> {
        let draws = self.passes.iter().filter_map(|pass| match &pass.kind {
            PassKind::Draw(draw) => Some(&draw.shader.bindings),
            _ => None,
        });
        draws.flatten().filter_map(|binding| match &binding.bound {
            Bound::MaterialTexture { input, .. } | Bound::MaterialSampler { input, .. } => Some(input.as_str()),
            _ => None,
        })
    }

    /// Whether passes bind the textures of an input's materials.
    pub fn binds_materials(&self, input: &str) -> bool {
        self.materials().any(|bound| bound == input)
    }
}

/// What planning did to the order of the program, without changing what comes out.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Order {
    pub folded: Vec<Folded>,
    pub moved: Vec<Moved>,
}

/// A clear that became the load of a target. It is no pass any more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folded {
    /// Path of the clear.
    pub clear: String,
    /// Path of the draw whose target it was.
    pub into: String,
}

/// Passes that run before one that the program has before them, to share a pass of the device
/// with others of their kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moved {
    pub passes: Range<usize>,
    /// The first of those that they were brought in front of.
    pub before: usize,
}

/// One piece of memory with an identity.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Instance path, such as `shapes.grid.order`.
    pub path: String,
    pub kind: ObjectKind,
    pub origin: Origin,
    /// What a person is warned of when a frame appended nothing to it.
    pub empty: Option<String>,
    /// First and last index into [`Plan::passes`] that touch it; absent if none does.
    pub lifetime: Option<(usize, usize)>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub enum ObjectKind {
    Texture(Texture),
    Buffer(Buffer),
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Texture {
    pub format: TextureFormat,
    pub width: u32,
    pub height: u32,
    /// Array layers, or the depth of a 3D texture.
    pub layers: u32,
    pub is_3d: bool,
    pub mips: u32,
    pub samples: u32,
    pub usages: TextureUsages,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Buffer {
    /// Bytes of one item, as all shaders agree.
    pub stride: u32,
    /// Capacity of a counted buffer. May be 0; memory then has room for one.
    pub items: u64,
    /// Bytes before the first item: the count of a counted buffer with its padding.
    pub header: u32,
    pub counted: bool,
    /// What an item is, where a shader says so.
    pub item: Option<Type>,
    pub usages: BufferUsages,
}

impl Buffer {
    /// The exact range to bind, a multiple of 4, room for one item at least.
    pub fn bytes(&self) -> u64 {
        (u64::from(self.header) + self.items.max(1) * u64::from(self.stride)).next_multiple_of(4)
    }
}

/// Where an object's content comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// Passes of the frame write it.
    Frame,
    /// Survives frames; written in `Plan::steps[_]`.
    State(usize),
    /// A texture or buffer of an input of this name.
    Input(String),
    /// An attribute of a particle input.
    Attribute { input: String, attribute: String, present: bool },
    /// A buffer of a mesh input; the input is empty where nothing feeds it.
    Mesh { input: String, buffer: MeshBuffer },
}

impl Origin {
    /// The root's input that fills it, if one does.
    pub fn input(&self) -> Option<&str> {
        match self {
            Origin::Input(input) | Origin::Attribute { input, .. } | Origin::Mesh { input, .. } => Some(input),
            Origin::Frame | Origin::State(_) => None,
        }
    }
}

/// An object, or a member of a ring of state that steps rotate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ObjectRef {
    Fixed(ObjectId),
    /// `plan.rings[ring].objects[(index + rotation) % len]`, where `rotation` is how far the
    /// ring has turned when the pass runs.
    Ring {
        ring: usize,
        index: usize,
    },
}

/// State that swaps: after each step it turns by `turn`.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    pub objects: Vec<ObjectId>,
    pub turn: usize,
    pub steps: usize,
}

/// One `Steps` block: a contiguous range of passes.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    pub path: String,
    /// Hz; absent: once a frame.
    pub rate: Option<f64>,
    pub passes: Range<usize>,
    /// The value of the graph's own key.
    pub asked: Option<Value>,
    /// Changes when all its state has to start anew: with `asked`, or a declaration.
    pub key: u128,
    pub state: Vec<ObjectId>,
}

/// A `var<uniform>` that the host packs.
#[derive(Clone, Debug, PartialEq)]
pub struct UniformBlock {
    /// Bytes, as the shader's type has it.
    pub size: u32,
    pub members: Vec<UniformMember>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct UniformMember {
    pub name: Arc<str>,
    pub offset: u32,
    pub ty: Type,
    pub value: UniformValue,
}

#[derive(Clone, Debug, PartialEq)]
pub enum UniformValue {
    Known(Value),
    /// Evaluated each frame (or step); its names are `time`, `delta`, `frame`, `step`, or
    /// `input.field` of a camera, light or pointer.
    Live(Expr),
}

/// Passes that run or are skipped together (rule 37).
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Unit {
    pub passes: Vec<usize>,
    /// Those that its own passes have.
    pub own: Causes,
    /// Those of its own and of all units that it reads from.
    pub causes: Causes,
    /// The units that read what it writes, in program order, without itself.
    pub readers: Vec<usize>,
}

/// What a unit's results depend on, from outside the graph.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Causes {
    /// Inputs by name, whose version counts.
    pub inputs: BTreeSet<String>,
    /// Live names: `time`, `camera.position`, ...
    pub live: BTreeSet<String>,
    /// Parameters by instance path.
    pub params: BTreeSet<String>,
    pub viewport: bool,
}

impl Causes {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.inputs.len() + self.live.len() + self.params.len() + usize::from(self.viewport)
    }

    /// Those that others do not have.
    pub fn without(&self, others: &Causes) -> Causes {
        Causes {
            inputs: &self.inputs - &others.inputs,
            live: &self.live - &others.live,
            params: &self.params - &others.params,
            viewport: self.viewport && !others.viewport,
        }
    }

    /// Whether there is none: what has none runs once.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Culled {
    pub path: String,
    pub why: String,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    pub name: String,
    pub object: ObjectRef,
    /// Where the graph puts it out.
    pub span: Span,
}

/// What a device must offer, beyond nothing.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Needs {
    pub features: Features,
    /// Limits above WebGPU's defaults: (name, needed, default).
    pub limits: Vec<(String, u64, u64)>,
}

/// A parameter as users of a plan see it.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    pub path: String,
    pub kind: ParamKind,
    pub value: Value,
    pub default: Option<Value>,
    pub min: Option<Value>,
    pub max: Option<Value>,
    pub unit: Option<String>,
    pub about: Option<String>,
    pub span: Span,
}
