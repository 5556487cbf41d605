//! A plan: what happens in a frame, as plain data. The engine only carries it out.
//!
//! Every name is resolved, every size is a number, loops are unrolled, branches are taken. What
//! is left open is only what changes while frames run: time, cameras and lights (see
//! [`UniformValue::Live`]), and which memory a swapped state has (see [`ObjectRef::Ring`]).

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use wgpu_types::{BufferUsages, Features, Limits, ShaderStages, TextureUsages};

use crate::diagnostic::{Diagnostics, Span};
use crate::format::{SampleKind, TextureFormat};
use crate::graph::expr::Expr;
use crate::graph::model::{Blend, Compare, Face, ParamKind, Sampler, StencilOperation, Topology};
use crate::graph::value::Value;
use crate::shader::reflect::{Module, TextureDimension, Type};

use super::meshes::{MaterialTexture, MeshBuffer, MeshGeometry, MeshesInfo};

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
    /// Live passes in program order.
    pub passes: Vec<Pass>,
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

/// One piece of memory with an identity.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Instance path, such as `shapes.grid.order`.
    pub path: String,
    pub kind: ObjectKind,
    pub origin: Origin,
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
    /// Changes when all its state has to start anew.
    pub key: u128,
    pub state: Vec<ObjectId>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Instance path, such as `shapes.grid.sort/scan`, with `[2]` behind it in a loop.
    pub path: String,
    pub span: Span,
    pub unit: usize,
    /// Index into [`Plan::steps`].
    pub steps: Option<usize>,
    pub kind: PassKind,
    pub accesses: Vec<Access>,
    /// What it writes may depend on the order of atomics.
    pub unordered: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum PassKind {
    Compute {
        shader: ShaderUse,
        dispatch: Dispatch,
    },
    Draw(Box<Draw>),
    /// A texture's subresources or a whole buffer. Buffers clear to zero bytes, or to the word
    /// of `value[0]` by type.
    Clear {
        view: View,
        value: [f64; 4],
    },
    Copy {
        from: View,
        to: View,
    },
    /// Fills mips 1 and up from mip 0, made by the planner.
    Mips {
        texture: ObjectRef,
    },
    /// After appends: keeps the raw count for reporting, clamps it to the capacity, and writes
    /// the consumers' arguments. Made by the planner.
    Settle {
        counted: ObjectRef,
        arguments: Vec<Argument>,
    },
    /// Copies one item of draw arguments that a shader wrote into a slot, with `first_instance`
    /// 0. Made by the planner.
    Arguments {
        from: ObjectRef,
        offset: u64,
        indexed: bool,
        slot: u32,
    },
}

/// Arguments that [`PassKind::Settle`] writes to a slot, from the clamped count `n`.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// Byte offset is `slot * 32`.
    pub slot: u32,
    pub kind: ArgumentKind,
}

#[derive(Clone, Debug, PartialEq)]
pub enum ArgumentKind {
    /// `ceil(n / threads)` workgroups; more than 65,535 are folded into y.
    Dispatch { threads: u32 },
    /// Draw; what is absent is `n`.
    Draw { vertices: Option<u32>, instances: Option<u32>, indexed: bool },
}

#[derive(Clone, Debug, PartialEq)]
pub enum Dispatch {
    /// Workgroups; any zero skips. Folding is already done.
    Groups([u32; 3]),
    Indirect {
        slot: u32,
    },
}

/// A shader with everything it is fed.
#[derive(Clone, Debug, PartialEq)]
pub struct ShaderUse {
    pub module: usize,
    /// Entry names: the compute entry, or vertex and fragment.
    pub compute: Option<String>,
    pub vertex: Option<String>,
    pub fragment: Option<String>,
    /// Pipeline constants by key.
    pub constants: Vec<(String, f64)>,
    pub bindings: Vec<Binding>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    /// In bind group 0.
    pub binding: u32,
    /// The WGSL variable.
    pub name: String,
    pub stages: ShaderStages,
    pub bound: Bound,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Bound {
    /// A block that the host packs.
    Uniform {
        block: usize,
    },
    /// A buffer that a shader wrote, bound as uniform.
    UniformBuffer {
        buffer: ObjectRef,
    },
    Storage {
        buffer: ObjectRef,
        writable: bool,
    },
    Texture {
        view: View,
        sample: SampleKind,
        filtered: bool,
        multisampled: bool,
    },
    StorageTexture {
        view: View,
        format: TextureFormat,
        read: bool,
        write: bool,
    },
    Sampler {
        sampler: usize,
    },
    /// The factors of the material that is drawn: so many bytes of its item of a buffer.
    Material {
        buffer: ObjectRef,
        bytes: u32,
    },
    /// A texture of the material that is drawn.
    MaterialTexture {
        input: String,
        texture: MaterialTexture,
    },
    /// The sampler that goes with it.
    MaterialSampler {
        input: String,
        texture: MaterialTexture,
    },
}

/// A part of an object. For buffers the ranges are `0..1`.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    pub object: ObjectRef,
    pub mips: Range<u32>,
    pub layers: Range<u32>,
    pub dimension: TextureDimension,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    pub shader: ShaderUse,
    pub geometry: Geometry,
    pub topology: Topology,
    pub cull: Option<Face>,
    pub front_ccw: bool,
    pub color: Vec<ColorTarget>,
    pub depth: Option<DepthTarget>,
    pub samples: u32,
    /// x, y, width, height in pixels.
    pub region: Option<[u32; 4]>,
    /// Pixels of the targets.
    pub extent: [u32; 2],
}

#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// One triangle over the targets; the engine brings the vertex stage with `uv` at location 0.
    Fullscreen,
    Direct {
        vertices: u32,
        instances: u32,
    },
    /// `count` indices of 32 bits from the buffer.
    Indexed {
        indices: ObjectRef,
        count: u32,
        instances: u32,
    },
    Indirect {
        slot: u32,
        indices: Option<ObjectRef>,
    },
    /// The triangles of a mesh input.
    Meshes(MeshGeometry),
}

impl Geometry {
    /// The buffers that the draw takes vertices and indices from.
    pub fn buffers(&self) -> Vec<ObjectRef> {
        match self {
            Geometry::Fullscreen | Geometry::Direct { .. } | Geometry::Indirect { indices: None, .. } => Vec::new(),
            Geometry::Indexed { indices, .. } | Geometry::Indirect { indices: Some(indices), .. } => vec![*indices],
            Geometry::Meshes(meshes) => {
                meshes.vertices.iter().filter_map(|v| v.buffer).chain([meshes.indices]).collect()
            }
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct ColorTarget {
    pub view: View,
    pub format: TextureFormat,
    /// Absent: loads.
    pub clear: Option<[f64; 4]>,
    /// The content before is not needed and the pass does not clear: every pixel is written.
    pub discard_before: bool,
    pub blend: Option<Blend>,
    pub write: [bool; 4],
    pub resolve: Option<View>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct DepthTarget {
    pub view: View,
    pub format: TextureFormat,
    pub compare: Compare,
    pub write: bool,
    pub clear: Option<f32>,
    pub bias: (i32, f32),
    pub stencil: Option<Stencil>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Stencil {
    pub compare: Compare,
    pub pass: StencilOperation,
    pub fail: StencilOperation,
    pub depth_fail: StencilOperation,
    pub reference: u32,
    pub read_mask: u32,
    pub write_mask: u32,
    pub clear: Option<u32>,
}

/// What a pass does to subresources of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Access {
    pub object: ObjectRef,
    pub mips: Range<u32>,
    pub layers: Range<u32>,
    pub read: bool,
    pub write: bool,
    /// A write that leaves nothing of what was there.
    pub whole: bool,
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
    pub name: String,
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
    pub causes: Causes,
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

/// Which objects share memory, under both policies of rule 38.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Memory {
    /// Groups of objects that share one piece of memory while everything that skipping needs is
    /// kept.
    pub keep: Vec<Slot>,
    /// The same when every unit runs each frame.
    pub smallest: Vec<Slot>,
    /// Bytes of all objects of the frame, each on its own.
    pub unshared: u64,
    /// Bytes of the largest set that is live at once: no plan can hold less.
    pub lower_bound: u64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    pub objects: Vec<ObjectId>,
    pub bytes: u64,
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

/// Everything that planning needs to know from outside the graph.
#[derive(Clone, Debug)]
pub struct Request {
    pub viewport: [u32; 2],
    /// Parameter values by instance path; others have their defaults.
    pub params: BTreeMap<String, Value>,
    pub inputs: BTreeMap<String, InputInfo>,
    /// Capacities of counted buffers by instance path, in place of the declared ones.
    pub capacities: BTreeMap<String, u64>,
    /// Instance paths that somebody asks for besides the first output.
    pub roots: Vec<String>,
    pub features: Features,
    pub limits: Limits,
}

/// What feeds an input, as far as planning needs it.
#[derive(Clone, Debug, PartialEq)]
pub enum InputInfo {
    Camera,
    Light,
    Pointer,
    Particles {
        count: u64,
        /// Metres.
        radius: f64,
        min: [f64; 3],
        max: [f64; 3],
        /// Names and numbers of components.
        attributes: Vec<(String, u32)>,
    },
    Texture(Texture),
    Buffer {
        items: u64,
        stride: u32,
    },
    /// Rows, each with named values.
    Table {
        rows: Vec<BTreeMap<String, Value>>,
    },
    Meshes(MeshesInfo),
}

/// Visits every object that a pass refers to.
pub fn each_ref(kind: &mut PassKind, visit: &mut dyn FnMut(&mut ObjectRef)) {
    fn shader(shader: &mut ShaderUse, visit: &mut dyn FnMut(&mut ObjectRef)) {
        for binding in &mut shader.bindings {
            match &mut binding.bound {
                Bound::UniformBuffer { buffer } | Bound::Storage { buffer, .. } | Bound::Material { buffer, .. } => {
                    visit(buffer);
                }
                Bound::Texture { view, .. } | Bound::StorageTexture { view, .. } => visit(&mut view.object),
                Bound::Uniform { .. }
                | Bound::Sampler { .. }
                | Bound::MaterialTexture { .. }
                | Bound::MaterialSampler { .. } => {}
            }
        }
    }
    match kind {
        PassKind::Compute { shader: s, .. } => shader(s, visit),
        PassKind::Draw(draw) => {
            shader(&mut draw.shader, visit);
            match &mut draw.geometry {
                Geometry::Indexed { indices, .. } | Geometry::Indirect { indices: Some(indices), .. } => visit(indices),
                // What inputs fill is never swapped.
                _ => {}
            }
            for target in &mut draw.color {
                visit(&mut target.view.object);
                if let Some(resolve) = &mut target.resolve {
                    visit(&mut resolve.object);
                }
            }
            if let Some(depth) = &mut draw.depth {
                visit(&mut depth.view.object);
            }
        }
        PassKind::Clear { view, .. } => visit(&mut view.object),
        PassKind::Copy { from, to } => {
            visit(&mut from.object);
            visit(&mut to.object);
        }
        PassKind::Mips { texture } => visit(texture),
        PassKind::Settle { counted, .. } => visit(counted),
        PassKind::Arguments { from, .. } => visit(from),
    }
}
