//! What a plan's passes are: what they run, what they are fed, and what they touch.

use std::ops::Range;
use std::sync::Arc;

use wgpu_types::ShaderStages;

use super::ObjectRef;
use crate::diagnostic::Span;
use crate::format::{SampleKind, TextureFormat};
use crate::graph::model::{Blend, Compare, Face, StencilOperation, Topology};
use crate::plan::meshes::{MaterialTexture, MeshGeometry};
use crate::shader::reflect::TextureDimension;

#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Instance path, such as `shapes.grid.sort/scan`, with `[2]` behind it in a loop.
    pub path: String,
    pub span: Span,
    pub unit: usize,
    /// Index into [`super::Plan::steps`].
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

impl PassKind {
    /// Where a dispatch or draw has its arguments from, if not from the plan.
    pub fn slot(&self) -> Option<u32> {
        match self {
            PassKind::Compute { dispatch: Dispatch::Indirect { slot }, .. } => Some(*slot),
            PassKind::Draw(draw) => match draw.geometry {
                Geometry::Indirect { slot, .. } => Some(slot),
                _ => None,
            },
            _ => None,
        }
    }

    pub fn slot_mut(&mut self) -> Option<&mut u32> {
        match self {
            PassKind::Compute { dispatch: Dispatch::Indirect { slot }, .. } => Some(slot),
            PassKind::Draw(draw) => match &mut draw.geometry {
                Geometry::Indirect { slot, .. } => Some(slot),
                _ => None,
            },
            _ => None,
        }
    }
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
    pub name: Arc<str>,
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
                Geometry::Meshes(meshes) => {
                    visit(&mut meshes.indices);
                    meshes.vertices.iter_mut().filter_map(|v| v.buffer.as_mut()).for_each(&mut *visit);
                }
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
