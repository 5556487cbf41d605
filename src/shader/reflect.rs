//! What a WGSL module tells about itself, as plain data.

use std::path::PathBuf;
use std::sync::Arc;

use crate::diagnostic::{FileId, Span};
use crate::format::{SampleKind, TextureFormat};
use crate::shader::SourceMap;

/// A WGSL file with its imports, parsed, validated and reflected. All globals lie in bind group
/// 0, numbered in the order of declaration.
#[derive(Clone, Debug)]
pub struct Module {
    /// The named file.
    pub path: PathBuf,
    pub file: FileId,
    /// Every file of the module: the named one and all that it imports.
    pub files: Vec<PathBuf>,
    /// The assembled text's hash: equal hashes are equal modules.
    pub hash: u128,
    pub naga: Arc<naga::Module>,
    pub info: Arc<naga::valid::ModuleInfo>,
    pub globals: Vec<Global>,
    /// Entry points of the named file only.
    pub entries: Vec<Arc<Entry>>,
    pub overrides: Vec<Override>,
    /// Where places in naga's module lie in the files.
    pub map: Arc<SourceMap>,
}

/// A `var` that a pass has to feed.
#[derive(Clone, Debug, PartialEq)]
pub struct Global {
    pub name: Arc<str>,
    /// The name where it is declared.
    pub span: Span,
    pub binding: u32,
    pub kind: GlobalKind,
}

#[derive(Clone, Debug, PartialEq)]
pub enum GlobalKind {
    Uniform(Type),
    Storage {
        writable: bool,
        ty: Type,
    },
    Texture {
        dimension: TextureDimension,
        multisampled: bool,
        sample: SampleKind,
    },
    StorageTexture {
        dimension: TextureDimension,
        format: TextureFormat,
        read: bool,
        write: bool,
    },
    Sampler {
        comparison: bool,
    },
    /// Something that graphs cannot feed, such as an acceleration structure.
    Other(String),
}

/// A texture variable's dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TextureDimension {
    D1,
    D2,
    D2Array,
    Cube,
    CubeArray,
    D3,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scalar {
    F32,
    F16,
    I32,
    U32,
    Other,
}

/// A host-shareable type with its memory layout in bytes.
#[derive(Clone, Debug, PartialEq)]
pub enum Type {
    Scalar(Scalar),
    Atomic(Scalar),
    Vector {
        components: u32,
        scalar: Scalar,
    },
    Matrix {
        columns: u32,
        rows: u32,
        scalar: Scalar,
    },
    /// `count` is absent for a runtime-sized array.
    Array {
        element: Box<Type>,
        count: Option<u32>,
        stride: u32,
    },
    Struct {
        name: String,
        members: Vec<Member>,
        size: u32,
    },
}

#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    pub name: Arc<str>,
    pub offset: u32,
    pub ty: Type,
    /// The member's declaration, for labels.
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    Vertex,
    Fragment,
    Compute,
}

/// One entry point.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub name: String,
    pub span: Span,
    pub stage: Stage,
    /// As written; see [`Module::workgroup_size`] for sizes that overrides decide.
    pub workgroup_size: [u32; 3],
    /// Globals that it uses, through any depth of calls.
    pub uses: Vec<Use>,
    /// Indices of globals: (texture, sampler) pairs that are sampled together.
    pub sampled: Vec<(usize, usize)>,
    /// User-defined inputs: vertex attributes, or what a fragment stage takes.
    pub inputs: Vec<Io>,
    /// User-defined outputs: what a vertex stage hands on, or colour targets.
    pub outputs: Vec<Io>,
    pub writes_frag_depth: bool,
    pub discards: bool,
    /// Names of all functions it calls, through any depth.
    pub calls: Vec<String>,
    /// Features beyond WebGPU's defaults that its module needs: a device takes modules whole, so
    /// entry points of one module need the same.
    pub features: wgpu_types::Features,
    /// Bytes of `var<workgroup>` memory as WebGPU counts them, each variable rounded up to 16; see
    /// [`Module::workgroup_memory`] for sizes that overrides decide.
    pub workgroup_memory: u32,
}

/// How an entry point uses a global. One that is neither read nor written is asked for its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Use {
    /// Index into [`Module::globals`].
    pub global: usize,
    pub read: bool,
    pub write: bool,
    /// An atomic operation is among the accesses.
    pub atomic: bool,
    /// The order of threads may show: the old value that an atomic returned is used, an exchange
    /// compares, or what atomics change is loaded in the same entry point.
    pub atomic_result: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Io {
    pub location: u32,
    /// The member's or argument's name; empty for a bare result.
    pub name: String,
    pub ty: Type,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Override {
    pub name: String,
    pub span: Span,
    /// `Bool` overrides are `None`.
    pub scalar: Option<Scalar>,
    pub has_default: bool,
    /// The key that pipeline constants use.
    pub key: String,
}

impl Type {
    /// Size in bytes; of a runtime-sized array, and of a struct that ends in one, the fixed part.
    pub fn size(&self) -> u32 {
        match self {
            Type::Scalar(s) | Type::Atomic(s) => s.size(),
            Type::Vector { components, scalar } => components * scalar.size(),
            Type::Matrix { columns, rows, scalar } => columns * scalar.size() * if *rows == 2 { 2 } else { 4 },
            Type::Array { count, stride, .. } => count.unwrap_or(0) * stride,
            Type::Struct { size, .. } => *size,
        }
    }

    /// The runtime-sized array at its end: (offset, stride, element).
    pub fn runtime_array(&self) -> Option<(u32, u32, &Type)> {
        match self {
            Type::Array { element, count: None, stride } => Some((0, *stride, element)),
            Type::Struct { members, .. } => {
                let last = members.last()?;
                let (offset, stride, element) = last.ty.runtime_array()?;
                Some((last.offset + offset, stride, element))
            }
            _ => None,
        }
    }

    /// As WGSL writes it.
    pub fn wgsl(&self) -> String {
        match self {
            Type::Scalar(s) => s.wgsl().into(),
            Type::Atomic(s) => format!("atomic<{}>", s.wgsl()),
            Type::Vector { components, scalar } => format!("vec{components}<{}>", scalar.wgsl()),
            Type::Matrix { columns, rows, scalar } => format!("mat{columns}x{rows}<{}>", scalar.wgsl()),
            Type::Array { element, count: Some(n), .. } => format!("array<{}, {n}>", element.wgsl()),
            Type::Array { element, count: None, .. } => format!("array<{}>", element.wgsl()),
            Type::Struct { name, .. } => name.clone(),
        }
    }
}

impl Scalar {
    pub fn size(self) -> u32 {
        match self {
            Scalar::F16 => 2,
            Scalar::F32 | Scalar::I32 | Scalar::U32 => 4,
            Scalar::Other => 8,
        }
    }

    pub fn wgsl(self) -> &'static str {
        match self {
            Scalar::F32 => "f32",
            Scalar::F16 => "f16",
            Scalar::I32 => "i32",
            Scalar::U32 => "u32",
            Scalar::Other => "a 64-bit type",
        }
    }
}

impl Module {
    /// The entry points of a stage.
    pub fn stage(&self, stage: Stage) -> impl Iterator<Item = &Arc<Entry>> {
        self.entries.iter().filter(move |e| e.stage == stage)
    }

    pub fn global(&self, name: &str) -> Option<(usize, &Global)> {
        self.globals.iter().enumerate().find(|(_, g)| *g.name == *name)
    }
}
