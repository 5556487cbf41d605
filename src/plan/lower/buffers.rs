//! Storage buffers as shaders see them: the layout of their items, on which all of them agree.

use wgpu_types::BufferUsages;

use super::bind::Feed;
use super::nodes::Draft;
use super::view::Viewed;
use super::{Layout, Lowering, Result, ScopeId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::model::{Bound, ObjectKind, ObjectRef, Origin};
use crate::shader::reflect::{Scalar, Type};

impl Lowering<'_> {
    pub(super) fn feed_storage(
        &mut self,
        s: ScopeId,
        place: &Feed<'_>,
        writable: bool,
        ty: &Type,
        viewed: &Viewed,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let object = viewed.view.object;
        if !matches!(self.object(object).object.kind, ObjectKind::Buffer(_)) {
            return Err(self.mismatch_object(s, place, object));
        }
        self.agree(s, place, object, ty)?;
        let used = place.wanted.used;
        let origin = &self.object(object).object.origin;
        // A part by itself may write buffers that its user gives; nobody gives meshes to write.
        let may_be_given = self.stand_in && !matches!(origin, Origin::Mesh { .. });
        if used.write && !matches!(origin, Origin::Frame | Origin::State(_)) && !may_be_given {
            return Err(self.writes_input(s, place, object));
        }
        for id in self.object_ids(object) {
            if let ObjectKind::Buffer(buffer) = &mut self.objects[id].object.kind {
                buffer.usages |= BufferUsages::STORAGE;
            }
        }
        draft.accesses.push(self.access(place, &viewed.view, used, false));
        Ok(Bound::Storage { buffer: object, writable })
    }

    fn writes_input(&self, s: ScopeId, place: &Feed<'_>, object: ObjectRef) -> Box<Diagnostic> {
        let name = &self.object(object).object.path;
        let message = format!("the shader writes `{name}`, which is an input of the graph");
        let diagnostic = fault(Code::BINDING_MISMATCH, message, place.at, "written by this pass")
            .see(place.wanted.global.span, "the shader's variable")
            .see(self.object(object).object.span, "declared here")
            .hint("copy it to a resource first");
        traced(diagnostic, &self.scopes[s].trace)
    }

    /// All shaders that bind a buffer must agree on what it holds.
    pub(super) fn agree(&mut self, s: ScopeId, place: &Feed<'_>, object: ObjectRef, ty: &Type) -> Result<()> {
        let global = place.wanted.global;
        let building = self.object(object);
        let ObjectKind::Buffer(buffer) = &building.object.kind else { return Ok(()) };
        let found = if buffer.counted { counted_layout(ty, global.span) } else { plain_layout(ty, global.span) };
        let Some(mut layout) = found else {
            let message =
                format!("`{}` is a counted buffer, and the shader sees `{}`", building.object.path, ty.wgsl());
            let diagnostic = fault(Code::COUNTED, message, global.span, "the shader's variable")
                .see(place.at, "fed by this pass")
                .see(building.object.span, "declared here")
                .hint("a writer declares `struct { count: atomic<u32>, items: array<T> }`, a reader `count: u32`");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        if let Origin::Attribute { attribute, input, .. } = &building.object.origin {
            let components = self.attribute_components(input, attribute);
            layout = self.attribute_layout(s, place, layout, components)?;
        }
        if let Origin::Mesh { buffer, .. } = &building.object.origin {
            self.mesh_layout(s, place, buffer, &building.object.path, &layout)?;
        }
        if let Some(first) = &building.layout
            && !(first.header == layout.header && first.stride == layout.stride && same_type(&first.item, &layout.item))
        {
            let name = &building.object.path;
            let message = format!("two shaders disagree about what `{name}` holds");
            let diagnostic = fault(
                Code::LAYOUT_DISAGREEMENT,
                message,
                global.span,
                format!("`{}`, {} bytes each", layout.item.wgsl(), layout.stride),
            )
            .see(first.span, format!("`{}`, {} bytes each", first.item.wgsl(), first.stride))
            .see(building.object.span, "declared here")
            .hint(difference(&first.item, &layout.item));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let items = fixed_items(ty);
        if let Some(needed) = items
            && buffer.items < u64::from(needed)
            && matches!(building.object.origin, Origin::Frame | Origin::State(_))
        {
            let message =
                format!("the shader needs {needed} items of `{}`, which has {}", building.object.path, buffer.items);
            let diagnostic = fault(Code::BINDING_MISMATCH, message, global.span, "so many items")
                .see(building.object.span, "declared here");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        for id in self.object_ids(object) {
            let building = &mut self.objects[id];
            let ObjectKind::Buffer(buffer) = &mut building.object.kind else { continue };
            if building.layout.is_none() {
                buffer.header = layout.header;
                buffer.stride = layout.stride;
                buffer.item = Some(layout.item.clone());
                building.layout = Some(layout.clone());
            }
        }
        Ok(())
    }

    fn attribute_components(&self, input: &str, attribute: &str) -> Option<u32> {
        match self.request.inputs.get(input) {
            Some(crate::plan::model::InputInfo::Particles { attributes, .. }) => {
                attributes.iter().find(|(name, _)| name == attribute).map(|(_, n)| *n).filter(|n| *n > 0)
            }
            _ => None,
        }
    }

    /// Attributes are tightly packed: three numbers take 12 bytes, which `array<vec3<f32>>` does not have.
    fn attribute_layout(
        &self,
        s: ScopeId,
        place: &Feed<'_>,
        layout: Layout,
        components: Option<u32>,
    ) -> Result<Layout> {
        let global = place.wanted.global;
        if let Type::Vector { components: 3, .. } = layout.item {
            let message =
                format!("`{}` is tightly packed, 12 bytes each, and `array<vec3<...>>` takes 16", global.name);
            let diagnostic = fault(Code::BINDING_MISMATCH, message, global.span, "16 bytes each")
                .see(place.at, "fed by this pass")
                .hint("import \"lib/packed.wgsl\" and declare `array<Packed3>`");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let Some(components) = components else { return Ok(layout) };
        let lanes = lanes(&layout.item);
        if lanes == Some(components) || lanes == Some(1) {
            return Ok(layout);
        }
        let message = format!(
            "`{}` has {components} numbers for each particle, and the shader sees `{}`",
            global.name,
            layout.item.wgsl()
        );
        let diagnostic = fault(Code::BINDING_MISMATCH, message, global.span, "does not fit");
        let diagnostic = diagnostic.see(place.at, "fed by this pass").hint(match components {
            1 => "declare `array<f32>`, `array<u32>` or `array<i32>`".to_owned(),
            3 => "import \"lib/packed.wgsl\" and declare `array<Packed3>`".to_owned(),
            n => format!("declare `array<vec{n}<f32>>`"),
        });
        Err(traced(diagnostic, &self.scopes[s].trace))
    }
}

/// `{ count, items }` as counted buffers are seen.
fn counted_layout(ty: &Type, span: Span) -> Option<Layout> {
    let Type::Struct { members, .. } = ty else { return None };
    let [count, items] = members.as_slice() else { return None };
    let is_count = &*count.name == "count"
        && matches!(count.ty, Type::Scalar(Scalar::U32) | Type::Atomic(Scalar::U32))
        && count.offset == 0;
    let (offset, stride, item) = items.ty.runtime_array()?;
    (is_count && &*items.name == "items").then(|| Layout {
        header: items.offset + offset,
        stride,
        item: item.clone(),
        span,
    })
}

fn plain_layout(ty: &Type, span: Span) -> Option<Layout> {
    let layout = |header, stride, item: &Type| Some(Layout { header, stride, item: item.clone(), span });
    match (ty.runtime_array(), ty) {
        (Some((offset, stride, item)), _) => layout(offset, stride, item),
        (None, Type::Array { element, stride, .. }) => layout(0, *stride, element),
        (None, ty) => layout(0, ty.size(), ty),
    }
}

/// How many items a type of fixed size takes.
fn fixed_items(ty: &Type) -> Option<u32> {
    match ty {
        Type::Array { count: Some(n), .. } => Some(*n),
        other if other.runtime_array().is_none() => Some(1),
        _ => None,
    }
}

/// Number of scalars in a tightly packed item: a scalar, a vector, or a struct of scalars.
fn lanes(ty: &Type) -> Option<u32> {
    match ty {
        Type::Scalar(_) | Type::Atomic(_) => Some(1),
        Type::Vector { components, .. } => Some(*components),
        Type::Struct { members, size, .. } => {
            let all_scalars = members.iter().all(|m| matches!(m.ty, Type::Scalar(_)));
            (all_scalars && *size == 4 * members.len() as u32).then_some(members.len() as u32)
        }
        _ => None,
    }
}

/// Equal names, offsets and types; `atomic<T>` counts as `T`, struct names do not count.
pub(super) fn same_type(a: &Type, b: &Type) -> bool {
    match (a, b) {
        (Type::Scalar(x) | Type::Atomic(x), Type::Scalar(y) | Type::Atomic(y)) => x == y,
        (Type::Array { element: x, count: n, stride: p }, Type::Array { element: y, count: m, stride: q }) => {
            n == m && p == q && same_type(x, y)
        }
        (Type::Struct { members: x, size: p, .. }, Type::Struct { members: y, size: q, .. }) => {
            p == q
                && x.len() == y.len()
                && x.iter().zip(y).all(|(m, n)| m.name == n.name && m.offset == n.offset && same_type(&m.ty, &n.ty))
        }
        _ => a == b,
    }
}

/// Where two item types differ, as a hint.
fn difference(a: &Type, b: &Type) -> String {
    if let (Type::Struct { members: x, .. }, Type::Struct { members: y, .. }) = (a, b) {
        for (m, n) in x.iter().zip(y) {
            if m.name != n.name || m.offset != n.offset || !same_type(&m.ty, &n.ty) {
                return format!(
                    "one has `{}: {}` at byte {}, the other `{}: {}` at byte {}",
                    n.name,
                    n.ty.wgsl(),
                    n.offset,
                    m.name,
                    m.ty.wgsl(),
                    m.offset
                );
            }
        }
    }
    "declare the item's type once, in a module that both import".to_owned()
}
