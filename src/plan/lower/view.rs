//! Views: the part of a texture or buffer that a pass names.

use super::names::Entity;
use super::nodes::amount;
use super::{CauseSet, Lowering, Result, ScopeId, fault, traced};
use crate::diagnostic::Code;
use crate::graph::model as ast;
use crate::plan::model::{Access, ObjectKind, View};
use crate::shader::reflect::TextureDimension;

/// A view with what it was asked for, before it becomes part of a pass.
pub(super) struct Viewed {
    pub view: View,
    /// Whether the author named a mip or a layer.
    pub mip_said: bool,
    pub layer_said: bool,
    pub causes: CauseSet,
}

impl Lowering<'_> {
    /// A view as written: what is not said is whole.
    pub(super) fn view(&mut self, s: ScopeId, view: &ast::View) -> Result<Viewed> {
        let var = match self.resolve(s, &view.of.value, view.of.span)? {
            Entity::Var(var) => var,
            Entity::Absent => {
                return Err(self.absent_here(s, &view.of.value, view.of.span));
            }
            other => {
                let message = format!("`{}` is {}, not a texture or buffer", view.of.value, other.what());
                return Err(traced(
                    fault(Code::WRONG_KIND, message, view.of.span, "named here"),
                    &self.scopes[s].trace,
                ));
            }
        };
        let object = self.vars[var].now;
        let mut causes = CauseSet::default();
        let (mips, layers, dimension) = match &self.object(object).object.kind {
            ObjectKind::Texture(t) => {
                (t.mips, if t.is_3d { 1 } else { t.layers }, natural_dimension(t.is_3d, t.layers))
            }
            ObjectKind::Buffer(_) => (1, 1, TextureDimension::D2),
        };
        let mut part = |low: &mut Self, expr: &Option<crate::graph::expr::Expr>, what: &str, count: u32| match expr {
            None => Ok(0..count),
            Some(expr) => {
                let (n, depends) = low.whole(s, expr, what, 0)?;
                causes.add(&depends);
                if n >= i64::from(count) {
                    let message =
                        format!("`{}` has {}, and {what} {n} is asked for", view.of.value, amount(count, what));
                    let diagnostic = fault(Code::OUT_OF_RANGE, message, expr.span, format!("this is {n}"))
                        .hint(format!("{what}s count from 0"));
                    return Err(traced(diagnostic, &low.scopes[s].trace));
                }
                Ok(n as u32..n as u32 + 1)
            }
        };
        let mips = part(self, &view.mip, "mip", mips)?;
        let layers = part(self, &view.layer, "layer", layers)?;
        let dimension = if view.layer.is_some() { TextureDimension::D2 } else { dimension };
        causes.add(&self.object(object).causes);
        Ok(Viewed {
            view: View { object, mips, layers, dimension },
            mip_said: view.mip.is_some(),
            layer_said: view.layer.is_some(),
            causes,
        })
    }
}

pub(super) fn whole_write(view: &View) -> Access {
    Access {
        object: view.object,
        mips: view.mips.clone(),
        layers: view.layers.clone(),
        read: false,
        write: true,
        whole: true,
    }
}

/// How a whole texture is seen if nobody says otherwise.
pub(super) fn natural_dimension(is_3d: bool, layers: u32) -> TextureDimension {
    match (is_3d, layers) {
        (true, _) => TextureDimension::D3,
        (false, 1) => TextureDimension::D2,
        (false, _) => TextureDimension::D2Array,
    }
}
