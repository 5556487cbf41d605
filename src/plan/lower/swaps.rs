//! Names that swap: in a loop they rotate after each iteration, as state they are a ring.

use super::names::Entity;
use super::nodes::amount;
use super::{Lowering, Result, ScopeId, VarId, fault, traced};
use crate::diagnostic::Code;
use crate::graph::model::{Name, Sp};
use crate::plan::model::{ObjectId, ObjectKind, ObjectRef, Origin, Ring};

impl Lowering<'_> {
    pub(super) fn swap_vars(&mut self, s: ScopeId, tuple: &Sp<Vec<Name>>) -> Result<Vec<VarId>> {
        let mut vars = Vec::new();
        for name in &tuple.value {
            match self.resolve(s, &name.value, name.span)? {
                Entity::Var(var) => vars.push(var),
                other => {
                    let message = format!("`{}` is {} and cannot be swapped", name.value, other.what());
                    return Err(traced(
                        fault(Code::WRONG_KIND, message, name.span, "in a swap"),
                        &self.scopes[s].trace,
                    ));
                }
            }
        }
        let objects: Vec<ObjectRef> = vars.iter().map(|v| self.vars[*v].now).collect();
        let unlike = (1..vars.len()).find(|i| !self.alike(objects[0], objects[*i]));
        if let Some(i) = unlike {
            let (first, other) = (&tuple.value[0], &tuple.value[i]);
            let (a, b) = (self.describe_object(objects[0]), self.describe_object(objects[i]));
            let message = format!("`{}` and `{}` swap, and are not alike", first.value, other.value);
            let diagnostic = fault(Code::UNLIKE_SWAP, message, tuple.span, "swapped here")
                .see(self.object(objects[0]).object.span, format!("{a}{}", self.extent_of(objects[0])))
                .see(self.object(objects[i]).object.span, format!("{b}{}", self.extent_of(objects[i])))
                .hint(format!("declare one as `Like(\"{}\")`", first.value));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        self.join_swapped(s, tuple, &objects)?;
        Ok(vars)
    }

    /// After an iteration the names rotate: the first name gets what the last had.
    pub(super) fn rotate(&mut self, vars: &[VarId]) {
        if let Some(last) = vars.last() {
            let mut carried = self.vars[*last].now;
            for var in vars {
                std::mem::swap(&mut self.vars[*var].now, &mut carried);
            }
        }
    }

    fn alike(&self, a: ObjectRef, b: ObjectRef) -> bool {
        let (a, b) = (self.object(a), self.object(b));
        let state = |o: &Origin| matches!(o, Origin::State(_));
        same_extent(&a.object.kind, &b.object.kind) && state(&a.object.origin) == state(&b.object.origin)
    }

    pub(super) fn extent_of(&self, object: ObjectRef) -> String {
        match &self.object(object).object.kind {
            ObjectKind::Texture(t) => format!(", {} x {}, {}", t.width, t.height, amount(t.mips, "mip")),
            ObjectKind::Buffer(b) => format!(" of {}", amount(b.items, "item")),
        }
    }

    /// Names that swap count as one; state that swaps becomes a ring.
    fn join_swapped(&mut self, s: ScopeId, tuple: &Sp<Vec<Name>>, objects: &[ObjectRef]) -> Result<()> {
        let ids: Vec<ObjectId> = objects.iter().map(|o| self.object_id(*o)).collect();
        self.swapped.push(ids.iter().copied().collect());
        let is_state = ids.iter().any(|id| matches!(self.objects[*id].object.origin, Origin::State(_)));
        if !is_state {
            return Ok(());
        }
        let Some(steps) = self.in_steps else {
            let diagnostic = fault(Code::STATE, "state is swapped outside `Steps`", tuple.span, "swapped here")
                .hint("move the loop into the `Steps` that writes the state");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        if self
            .rings
            .iter()
            .any(|ring| ids.iter().all(|id| ring.objects.contains(id)) && ring.objects.len() == ids.len())
        {
            return Ok(());
        }
        let ring = self.rings.len();
        self.rings.push(Ring { objects: ids.clone(), turn: 0, steps });
        for var in &mut self.vars {
            if let ObjectRef::Fixed(id) = var.now
                && let Some(index) = ids.iter().position(|i| *i == id)
            {
                var.now = ObjectRef::Ring { ring, index };
            }
        }
        Ok(())
    }
}

/// Whether two objects hold the same: what uses them does not count.
pub(super) fn same_extent(a: &ObjectKind, b: &ObjectKind) -> bool {
    match (a, b) {
        (ObjectKind::Texture(x), ObjectKind::Texture(y)) => {
            (x.format, x.width, x.height, x.layers, x.is_3d, x.mips, x.samples)
                == (y.format, y.width, y.height, y.layers, y.is_3d, y.mips, y.samples)
        }
        (ObjectKind::Buffer(x), ObjectKind::Buffer(y)) => (x.items, x.counted) == (y.items, y.counted),
        _ => false,
    }
}

/// ` 64 x 64 texels, 3 layers, 1 mip`, ` 4 items`.
pub(super) fn extent(kind: &ObjectKind) -> String {
    match kind {
        ObjectKind::Texture(t) => {
            let layers =
                if t.is_3d || t.layers > 1 { format!(", {}", amount(t.layers, "layer")) } else { String::new() };
            let mips = if t.mips > 1 { format!(", {}", amount(t.mips, "mip")) } else { String::new() };
            format!(" {} x {} texels{layers}{mips}", t.width, t.height)
        }
        ObjectKind::Buffer(b) => format!(" {}", amount(b.items, "item")),
    }
}
