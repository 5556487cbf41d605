//! `Clear` and `Copy`: the passes that have no shader.

use super::nodes::Draft;
use super::view::whole_write;
use super::{CauseSet, Lowering, Place, Result, ScopeId, fault, traced};
use crate::diagnostic::Code;
use crate::graph::model as ast;
use crate::plan::model::{Access, ObjectKind, PassKind};

impl Lowering<'_> {
    pub(super) fn clear(&mut self, s: ScopeId, clear: &ast::Clear) -> Result<Draft> {
        let mut viewed = self.view(s, &clear.of)?;
        let (value, causes) = self.clear_value(s, &clear.value)?;
        viewed.causes.add(&causes);
        if let ObjectKind::Buffer(_) = &self.object(viewed.view.object).object.kind
            && value.iter().any(|v| *v != value[0])
        {
            let diagnostic = fault(Code::BAD_PASS, "a buffer clears to one value", clear.of.span, "a buffer");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let place = Place::at(clear.of.span, &clear.of.of.value, true);
        let access = whole_write(&viewed.view);
        let mut draft = Draft::new(PassKind::Clear { view: viewed.view, value });
        draft.causes = viewed.causes;
        draft.accesses.push((access, place));
        Ok(draft)
    }

    /// One value for all channels, or four.
    pub(super) fn clear_value(
        &mut self,
        s: ScopeId,
        value: &[crate::graph::expr::Expr],
    ) -> Result<([f64; 4], CauseSet)> {
        let mut causes = CauseSet::default();
        let mut channels = Vec::new();
        for expr in value {
            let (value, depends) = self.known(s, expr)?;
            causes.add(&depends);
            for component in value.components() {
                match component.as_f64() {
                    Some(x) if x.is_finite() => channels.push(x),
                    _ => return Err(self.mistyped(s, expr, "a finite number", &value)),
                }
            }
        }
        match channels.as_slice() {
            [] => Ok(([0.0; 4], causes)),
            [x] => Ok(([*x; 4], causes)),
            [r, g, b] => Ok(([*r, *g, *b, 1.0], causes)),
            [r, g, b, a] => Ok(([*r, *g, *b, *a], causes)),
            _ => {
                let at = value.first().map_or(self.scopes[s].graph.span, |e| e.span);
                let message = format!("a clear value has 1, 3 or 4 numbers, not {}", channels.len());
                Err(traced(fault(Code::WRONG_VALUE, message, at, "the value"), &self.scopes[s].trace))
            }
        }
    }

    pub(super) fn copy(&mut self, s: ScopeId, copy: &ast::Copy) -> Result<Draft> {
        let (from, to) = (self.view(s, &copy.from)?, self.view(s, &copy.to)?);
        let fits = match (&self.object(from.view.object).object.kind, &self.object(to.view.object).object.kind) {
            (ObjectKind::Texture(a), ObjectKind::Texture(b)) => {
                let edge = |n: u32, mip: u32| (n >> mip).max(1);
                let (m, n) = (from.view.mips.start, to.view.mips.start);
                a.format == b.format
                    && a.samples == b.samples
                    && a.is_3d == b.is_3d
                    && edge(a.width, m) == edge(b.width, n)
                    && edge(a.height, m) == edge(b.height, n)
                    && from.view.layers.len() == to.view.layers.len()
                    && from.view.mips.len() == to.view.mips.len()
            }
            (ObjectKind::Buffer(a), ObjectKind::Buffer(b)) => a.items == b.items && a.counted == b.counted,
            _ => false,
        };
        if !fits {
            let message =
                format!("`{}` and `{}` are not alike and cannot be copied", copy.from.of.value, copy.to.of.value);
            let (a, b) = (self.describe_object(from.view.object), self.describe_object(to.view.object));
            let (ea, eb) = (self.extent_of(from.view.object), self.extent_of(to.view.object));
            let diagnostic = fault(Code::BAD_PASS, message, copy.to.span, format!("{b}{eb}"))
                .see(copy.from.span, format!("{a}{ea}"));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let read = Access { read: true, write: false, whole: false, ..whole_write(&from.view) };
        let write = whole_write(&to.view);
        let mut draft = Draft::new(PassKind::Copy { from: from.view, to: to.view });
        draft.causes.add(&from.causes);
        draft.causes.add(&to.causes);
        draft.accesses.push((read, Place::at(copy.from.span, &copy.from.of.value, false)));
        draft.accesses.push((write, Place::at(copy.to.span, &copy.to.of.value, true)));
        Ok(draft)
    }
}
