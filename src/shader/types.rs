//! naga's types as this program's.

use std::cell::Cell;

use naga::{ImageClass, ImageDimension, ScalarKind, StorageAccess, TypeInner};

use super::declare::Declarations;
use super::map::SourceMap;
use super::reflect::{GlobalKind, Member, Scalar, TextureDimension, Type};
use crate::diagnostic::Span;
use crate::format::SampleKind;

/// What types are looked up in.
pub(super) struct Types<'a> {
    pub module: &'a naga::Module,
    pub map: &'a SourceMap,
    pub declarations: &'a Declarations,
    /// Members that types may still be spelt out into: structs of structs that each hold the next
    /// twice would fill the memory.
    pub budget: Cell<u32>,
}

pub(super) fn scalar(scalar: naga::Scalar) -> Scalar {
    match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) => Scalar::F32,
        (ScalarKind::Float, 2) => Scalar::F16,
        (ScalarKind::Sint, 4) => Scalar::I32,
        (ScalarKind::Uint, 4) => Scalar::U32,
        _ => Scalar::Other,
    }
}

impl Types<'_> {
    /// A type with a layout, or nothing for textures, pointers and the like.
    pub fn host(&self, handle: naga::Handle<naga::Type>) -> Option<Type> {
        let ty = &self.module.types[handle];
        Some(match &ty.inner {
            TypeInner::Scalar(s) => Type::Scalar(scalar(*s)),
            TypeInner::Atomic(s) => Type::Atomic(scalar(*s)),
            TypeInner::Vector { size, scalar: s } => Type::Vector { components: u32::from(*size), scalar: scalar(*s) },
            TypeInner::Matrix { columns, rows, scalar: s } => {
                Type::Matrix { columns: u32::from(*columns), rows: u32::from(*rows), scalar: scalar(*s) }
            }
            TypeInner::Array { base, size, stride } => Type::Array {
                element: Box::new(self.host(*base)?),
                count: match size {
                    naga::ArraySize::Constant(count) => Some(count.get()),
                    naga::ArraySize::Pending(_) | naga::ArraySize::Dynamic => None,
                },
                stride: *stride,
            },
            TypeInner::Struct { members, span } => {
                let name = ty.name.clone().unwrap_or_default();
                let members = members.iter().map(|m| self.member(handle, &name, m)).collect::<Option<_>>()?;
                Type::Struct { name, members, size: *span }
            }
            _ => return None,
        })
    }

    /// One of a struct's members, or nothing if there are more than anybody writes.
    fn member(&self, of: naga::Handle<naga::Type>, of_name: &str, member: &naga::StructMember) -> Option<Member> {
        self.budget.set(self.budget.get().checked_sub(1)?);
        let name = member.name.clone().unwrap_or_default();
        let span = self.declarations.member(of_name, &name).unwrap_or_else(|| self.declared(of));
        Some(Member { offset: member.offset, ty: self.host(member.ty)?, name: name.into(), span })
    }

    /// Where a type is written; the start of the named file for one that WGSL has built in.
    fn declared(&self, handle: naga::Handle<naga::Type>) -> Span {
        self.map.span(self.module.types.get_span(handle)).unwrap_or_else(|| self.map.start())
    }

    pub fn global(&self, variable: &naga::GlobalVariable) -> GlobalKind {
        let host = || self.host(variable.ty);
        match variable.space {
            naga::AddressSpace::Uniform => host().map(GlobalKind::Uniform),
            naga::AddressSpace::Storage { access } => {
                let writable = access.contains(StorageAccess::STORE);
                host().map(|ty| GlobalKind::Storage { writable, ty })
            }
            _ => self.opaque(variable.ty),
        }
        .unwrap_or_else(|| GlobalKind::Other(self.name(variable.ty)))
    }

    /// A texture or sampler.
    fn opaque(&self, handle: naga::Handle<naga::Type>) -> Option<GlobalKind> {
        match self.module.types[handle].inner {
            TypeInner::Sampler { comparison } => Some(GlobalKind::Sampler { comparison }),
            TypeInner::Image { dim, arrayed, class } => texture(dimension(dim, arrayed)?, class),
            _ => None,
        }
    }

    /// As WGSL writes it.
    pub fn name(&self, handle: naga::Handle<naga::Type>) -> String {
        use naga::common::wgsl::TypeContext as _;
        self.module.to_ctx().type_to_string(handle)
    }
}

fn dimension(dimension: ImageDimension, arrayed: bool) -> Option<TextureDimension> {
    Some(match (dimension, arrayed) {
        (ImageDimension::D1, false) => TextureDimension::D1,
        (ImageDimension::D2, false) => TextureDimension::D2,
        (ImageDimension::D2, true) => TextureDimension::D2Array,
        (ImageDimension::D3, false) => TextureDimension::D3,
        (ImageDimension::Cube, false) => TextureDimension::Cube,
        (ImageDimension::Cube, true) => TextureDimension::CubeArray,
        (ImageDimension::D1 | ImageDimension::D3, true) => return None,
    })
}

fn texture(dimension: TextureDimension, class: ImageClass) -> Option<GlobalKind> {
    Some(match class {
        ImageClass::Sampled { kind, multi } => {
            let sample = match kind {
                ScalarKind::Sint => SampleKind::Sint,
                ScalarKind::Uint => SampleKind::Uint,
                _ => SampleKind::Float,
            };
            GlobalKind::Texture { dimension, multisampled: multi, sample }
        }
        ImageClass::Depth { multi } => {
            GlobalKind::Texture { dimension, multisampled: multi, sample: SampleKind::Depth }
        }
        ImageClass::Storage { format, access } => GlobalKind::StorageTexture {
            dimension,
            format: wgpu_naga_bridge::map_storage_format_from_naga(format),
            // Atomic access reads and writes.
            read: access.intersects(StorageAccess::LOAD | StorageAccess::ATOMIC),
            write: access.intersects(StorageAccess::STORE | StorageAccess::ATOMIC),
        },
        ImageClass::External => return None,
    })
}
