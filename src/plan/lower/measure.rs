//! What expressions ask of things: how large they are, and whether they are there.

use super::names::Entity;
use super::{CauseKind, CauseSet, Lowering, Result, Scalar, ScopeId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::expr::Function;
use crate::graph::value::Value;
use crate::plan::model::{self, ObjectKind, UniformValue};

impl Lowering<'_> {
    /// `size(x)`, `count(x)`, `capacity(x)`, `has(x)`, `device(x)`.
    pub(super) fn measure(&mut self, s: ScopeId, f: Function, path: &str, span: Span) -> Result<(Value, CauseSet)> {
        match f {
            Function::Has => return self.has(s, path, span),
            Function::Device => return self.device_has(s, path, span),
            _ => {}
        }
        let entity = self.resolve(s, path, span)?;
        let refuse = |low: &Self, what: &str| {
            let message = format!("`{}({path})`: `{path}` {what}", f.name());
            Err(traced(fault(Code::WRONG_KIND, message, span, "not possible"), &low.scopes[s].trace))
        };
        match (f, &entity) {
            (Function::Count, Entity::Input { .. }) => {
                let scalar = self.resolve(s, &format!("{path}.count"), span)?;
                match scalar {
                    Entity::Scalar(Scalar { value: UniformValue::Known(value), causes }) => Ok((value, causes)),
                    _ => refuse(self, "has no count"),
                }
            }
            (Function::Size | Function::Count | Function::Capacity, Entity::Var(var)) => {
                let building = self.object(self.vars[*var].now);
                let causes = building.causes.clone();
                match (f, &building.object.kind) {
                    (Function::Size, ObjectKind::Texture(t)) => {
                        let size = [t.width, t.height].into_iter().chain(t.is_3d.then_some(t.layers));
                        Ok((Value::ints(size.map(i64::from)), causes))
                    }
                    (Function::Count, ObjectKind::Buffer(b)) if b.counted => {
                        let message = format!("the count of `{path}` is known only on the GPU");
                        let diagnostic =
                            fault(Code::NOT_KNOWN_WHEN_PLANNING, message, span, "decided while a frame runs").hint(
                                format!("`capacity({path})` is known, and `Each(\"{path}\")` runs once for each item"),
                            );
                        Err(traced(diagnostic, &self.scopes[s].trace))
                    }
                    (Function::Count, ObjectKind::Buffer(b)) | (Function::Capacity, ObjectKind::Buffer(b)) => {
                        Ok((Value::Int(i64::try_from(b.items).unwrap_or(i64::MAX)), causes))
                    }
                    (Function::Size, _) => refuse(self, "is a buffer and has no size; `count` tells how many items"),
                    _ => refuse(self, "is a texture and has no count; `size` tells its width and height"),
                }
            }
            (_, other) => {
                let what = format!("is {}", other.what());
                refuse(self, &what)
            }
        }
    }

    fn has(&mut self, s: ScopeId, path: &str, span: Span) -> Result<(Value, CauseSet)> {
        let head = path.split('.').next().unwrap_or(path);
        let causes = self.causes.set(CauseKind::Input, head);
        let graph = self.scopes[s].graph.clone();
        let Some(input) = graph.inputs.iter().find(|i| i.name.value == head) else {
            let names: Vec<&str> = graph.inputs.iter().map(|i| i.name.value.as_str()).collect();
            let diagnostic =
                fault(Code::UNKNOWN_NAME, format!("`{head}` is no input"), span, "unknown input").nearest(head, names);
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        self.used.insert(input.name.span);
        let there = match self.resolve(s, path, span) {
            Ok(entity) if self.is_absent(&entity) => false,
            Ok(Entity::Var(var)) => {
                let origin = &self.object(self.vars[var].now).object.origin;
                !matches!(origin, model::Origin::Attribute { present: false, .. })
            }
            Ok(_) => true,
            Err(d) if d.id == Code::OPTIONAL_INPUT => false,
            Err(d) => return Err(d),
        };
        Ok((Value::Bool(there), causes))
    }

    fn device_has(&mut self, s: ScopeId, feature: &str, span: Span) -> Result<(Value, CauseSet)> {
        let known = wgpu_types::Features::all();
        let found = known.iter_names().find(|(name, _)| name.eq_ignore_ascii_case(feature));
        match found {
            Some((_, flag)) => Ok((Value::Bool(self.request.features.contains(flag)), CauseSet::default())),
            None => {
                let names: Vec<String> = known.iter_names().map(|(name, _)| name.to_ascii_lowercase()).collect();
                let diagnostic =
                    fault(Code::UNKNOWN_NAME, format!("`{feature}` is no device feature"), span, "unknown")
                        .nearest(feature, names.iter().map(String::as_str));
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
        }
    }
}
