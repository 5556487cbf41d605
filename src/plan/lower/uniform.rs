//! Packing uniforms and pipeline constants: every member gets the scalar of its name.

use std::sync::Arc;

use wgpu_types::BufferUsages;

use super::bind::{Feed, Stages, place_of};
use super::inputs::input_fields;
use super::names::Entity;
use super::nodes::{Draft, shown};
use super::{Lowering, Result, Scalar, ScopeId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::expr::{Expr, ExprKind};
use crate::graph::model::{self as ast, Name};
use crate::graph::value::Value;
use crate::plan::fields::{self, FieldType};
use crate::plan::meshes::MATERIAL;
use crate::plan::model::{Access, Bound, ObjectKind, Param, UniformBlock, UniformMember, UniformValue};
use crate::shader::reflect::{self, Member, Type};

/// Where the members of a block come from, besides `bind` and the names of the scope.
enum Prefix {
    None,
    /// Fields of an input of the root, by the name it has here.
    Input {
        root: Arc<str>,
        kind: ast::InputKind,
    },
    /// Outputs of a part: `grid` and `cell_size` is `grid.cell_size`.
    Use(String),
}

/// A scalar, and the path that it was found by.
type Named = (Option<Arc<str>>, Scalar);

impl Lowering<'_> {
    /// A `var<uniform>`: a buffer that a shader wrote, or a block that the host packs.
    pub(super) fn feed_uniform(
        &mut self,
        s: ScopeId,
        place: &Feed<'_>,
        ty: &Type,
        found: Option<Entity>,
        draft: &mut Draft,
    ) -> Result<Bound> {
        let prefix = match found {
            Some(Entity::Var(var)) => {
                let object = self.vars[var].now;
                if !matches!(&self.object(object).object.kind, ObjectKind::Buffer(b) if !b.counted) {
                    return Err(self.mismatch(s, place, &Entity::Var(var)));
                }
                self.agree(s, place, object, ty)?;
                for id in self.object_ids(object) {
                    if let ObjectKind::Buffer(buffer) = &mut self.objects[id].object.kind {
                        buffer.usages |= BufferUsages::UNIFORM;
                    }
                }
                let access = Access { object, mips: 0..1, layers: 0..1, read: true, write: false, whole: false };
                let mut at = super::Place::at(place.at, &place.global().name, false);
                at.shader = Some(place.global().span);
                draft.accesses.push((access, at));
                draft.causes.add(&self.object(object).causes);
                return Ok(Bound::UniformBuffer { buffer: object });
            }
            Some(Entity::Input { root, kind }) => Prefix::Input { root, kind },
            Some(Entity::Part) => Prefix::Use(place.global().name.to_string()),
            Some(Entity::Absent) => return Err(self.absent_fed_to(s, place)),
            _ => Prefix::None,
        };
        let block = match ty {
            Type::Struct { members, size, .. } => {
                let mut packed = Vec::new();
                for member in members {
                    let value = self.member(s, place, &prefix, member, draft);
                    packed.extend(self.report(value));
                }
                UniformBlock { size: *size, members: packed }
            }
            other => {
                let global = place.global();
                let only = Member { name: global.name.clone(), offset: 0, ty: other.clone(), span: global.span };
                UniformBlock { size: other.size(), members: vec![self.member(s, place, &prefix, &only, draft)?] }
            }
        };
        let index = self.uniforms.iter().position(|b| *b == block).unwrap_or_else(|| {
            self.uniforms.push(block);
            self.uniforms.len() - 1
        });
        Ok(Bound::Uniform { block: index })
    }

    fn member(
        &mut self,
        s: ScopeId,
        place: &Feed<'_>,
        prefix: &Prefix,
        member: &Member,
        draft: &mut Draft,
    ) -> Result<UniformMember> {
        let found = match bound_expr(place.bind, &member.name) {
            Some(expr) => Some((path_of(expr), self.scalar(s, expr)?)),
            None => self.named(s, prefix, member, place.stages.at)?,
        };
        let Some((path, scalar)) = found else { return Err(self.unfed(s, place, prefix, member)) };
        let scalar = self.word_as_index(s, path.as_deref(), scalar);
        if !fits(&scalar.value, &member.ty) {
            return Err(self.misfit(s, place, member.span, &member.name, &member.ty.wgsl(), &scalar));
        }
        if self.depends_on_value(&scalar, &member.ty) {
            self.structural.add(&scalar.causes);
        }
        draft.causes.add(&scalar.causes);
        Ok(UniformMember {
            name: member.name.clone(),
            offset: member.offset,
            ty: member.ty.clone(),
            value: scalar.value,
        })
    }

    /// The scalar of a member's name.
    fn named(&mut self, s: ScopeId, prefix: &Prefix, member: &Member, at: Span) -> Result<Option<Named>> {
        match prefix {
            Prefix::Input { root, kind } if input_fields(kind).any(|field| field == &*member.name) => {
                if !matches!(kind, ast::InputKind::Particles { .. } | ast::InputKind::Meshes { .. }) {
                    return Ok(Some((None, self.live_field(root, &member.name, member.span))));
                }
                if let Entity::Scalar(scalar) = self.resolve(0, &format!("{root}.{}", member.name), member.span)? {
                    return Ok(Some((None, scalar)));
                }
            }
            Prefix::Use(name) => {
                let child = self.child(s, name, member.span)?;
                let output = self.scopes[child].graph.outputs.iter().any(|o| *o.name.value == *member.name);
                let path = format!("{name}.{}", member.name);
                if output && let Entity::Scalar(scalar) = self.resolve(s, &path, member.span)? {
                    return Ok(Some((Some(path.into()), scalar)));
                }
            }
            _ => {}
        }
        match self.resolve_wgsl(s, &member.name, member.span)? {
            Some((path, Entity::Scalar(scalar))) => Ok(Some((Some(path), scalar))),
            Some((path, other)) => {
                let message =
                    format!("the member `{}` wants a scalar, and `{path}` is {}", member.name, self.what(&other));
                let diagnostic =
                    fault(Code::UNIFORM_MISMATCH, message, member.span, "the member").see(at, "run by this pass");
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
            None => Ok(None),
        }
    }

    fn unfed(&mut self, s: ScopeId, place: &Feed<'_>, prefix: &Prefix, member: &Member) -> Box<Diagnostic> {
        let mut names: Vec<String> = self.visible(s).into_iter().map(|name| name.replace('.', "_")).collect();
        if let Prefix::Input { kind, .. } = prefix {
            names = input_fields(kind).map(str::to_owned).collect();
        }
        let message = format!("nothing feeds the member `{}` of `{}`", member.name, place.global().name);
        let mut diagnostic = fault(Code::UNBOUND, message, member.span, "the member")
            .see(place.stages.at, "run by this pass")
            .nearest(&member.name, names.iter().map(String::as_str));
        if MATERIAL.iter().any(|(name, _)| *name == &*member.name) {
            diagnostic = diagnostic.hint("materials are there in a `Draw(meshes: ...)`, as `var<uniform> material`");
        }
        diagnostic = match prefix {
            Prefix::Input { kind, .. } => {
                diagnostic.hint(format!("a {} has {}", kind.name(), super::names::list(&names)))
            }
            _ => diagnostic.hint(format!(
                "declare a parameter or `let` called `{0}`, or say `bind: {{\"{0}\": \"...\"}}`",
                member.name
            )),
        };
        traced(diagnostic, &self.scopes[s].trace)
    }

    fn misfit(
        &self,
        s: ScopeId,
        place: &Feed<'_>,
        at: Span,
        name: &str,
        wgsl: &str,
        scalar: &Scalar,
    ) -> Box<Diagnostic> {
        let is = shown(&scalar.value);
        let message = format!("`{name}` is `{wgsl}` in the shader, and what feeds it is {is}");
        let mut diagnostic = fault(Code::UNIFORM_MISMATCH, message, at, format!("`{wgsl}`"));
        if let Some(param) = self.only_param(scalar) {
            diagnostic = diagnostic.see(param.span, format!("a parameter of kind {}", param.kind.name()));
        }
        let diagnostic = diagnostic.see(place_of(place.bind, name).unwrap_or(place.stages.at), "fed by this pass");
        let hint = "Int feeds i32, u32 and f32; Float f32; Bool and Choice u32; vectors and colours their vec";
        traced(diagnostic.hint(hint), &self.scopes[s].trace)
    }

    /// The one parameter that a value depends on.
    fn only_param(&self, scalar: &Scalar) -> Option<&Param> {
        self.params.get(self.causes.only_param(&scalar.causes)?)
    }

    /// Whether other values of the parameter behind a whole number may not fit where this one does.
    fn depends_on_value(&self, scalar: &Scalar, ty: &Type) -> bool {
        let may_be_negative =
            || self.only_param(scalar).is_none_or(|p| p.min.as_ref().and_then(Value::as_int).is_none_or(|m| m < 0));
        matches!(&scalar.value, UniformValue::Known(Value::Int(_)))
            && matches!(ty, Type::Scalar(reflect::Scalar::U32 | reflect::Scalar::I32))
            && may_be_negative()
    }

    /// WGSL sees a `Choice` as the index of its word.
    fn word_as_index(&mut self, s: ScopeId, path: Option<&str>, scalar: Scalar) -> Scalar {
        let UniformValue::Known(Value::Word(word)) = &scalar.value else { return scalar };
        let words = path.map_or_else(Vec::new, |path| self.choice_behind(s, path));
        match words.iter().position(|w| w == word) {
            Some(index) => Scalar { value: UniformValue::Known(Value::Int(index as i64)), ..scalar },
            None => scalar,
        }
    }

    /// The words of the `Choice` parameter that a path names, through outputs of parts.
    fn choice_behind(&mut self, s: ScopeId, path: &str) -> Vec<String> {
        let graph = self.scopes[s].graph.clone();
        if let Some(param) = graph.params.iter().find(|p| p.name.value == path) {
            return match &param.kind {
                ast::ParamKind::Choice(words) => words.iter().map(|w| w.value.clone()).collect(),
                _ => Vec::new(),
            };
        }
        let Some((head, rest)) = path.split_once('.') else { return Vec::new() };
        let Ok(child) = self.child(s, head, graph.span) else { return Vec::new() };
        let of = self.scopes[child].graph.outputs.iter().find(|o| o.name.value == rest).map(|o| o.of.value.clone());
        of.map_or_else(Vec::new, |of| self.choice_behind(child, &of))
    }

    /// `override` constants: from `bind`, else the scalar of the name, else their default.
    pub(super) fn constants(
        &mut self,
        s: ScopeId,
        stages: &Stages,
        bind: &[(Name, ast::Bound)],
        draft: &mut Draft,
    ) -> Vec<(String, f64)> {
        let mut constants = Vec::new();
        for constant in &stages.module.overrides {
            let value = self.constant(s, stages, bind, constant, draft);
            if let Some(Some(value)) = self.report(value) {
                constants.push((constant.key.clone(), value));
            }
        }
        constants
    }

    fn constant(
        &mut self,
        s: ScopeId,
        stages: &Stages,
        bind: &[(Name, ast::Bound)],
        constant: &reflect::Override,
        draft: &mut Draft,
    ) -> Result<Option<f64>> {
        let found = match bound_expr(bind, &constant.name) {
            Some(expr) => Some((path_of(expr), self.scalar(s, expr)?)),
            None => match self.resolve_wgsl(s, &constant.name, constant.span)? {
                Some((path, Entity::Scalar(scalar))) => Some((Some(path), scalar)),
                _ => None,
            },
        };
        let Some((path, scalar)) = found else {
            if constant.has_default {
                return Ok(None);
            }
            let message = format!("nothing feeds the constant `{}`", constant.name);
            let diagnostic = fault(Code::UNBOUND, message, constant.span, "no default")
                .see(stages.at, "run by this pass")
                .hint(format!("say `bind: {{\"{}\": \"...\"}}`, or give it a default", constant.name));
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        let scalar = self.word_as_index(s, path.as_deref(), scalar);
        let UniformValue::Known(value) = &scalar.value else {
            let message = format!("the constant `{}` must be known when planning", constant.name);
            let at = place_of(bind, &constant.name).unwrap_or(stages.at);
            let diagnostic = fault(Code::NOT_KNOWN_WHEN_PLANNING, message, at, "known only while a frame runs")
                .see(constant.span, "the constant")
                .hint("make it a member of a uniform");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        };
        let number = constant_value(value, constant.scalar);
        match number {
            Some(number) => {
                self.structural.add(&scalar.causes);
                draft.causes.add(&scalar.causes);
                Ok(Some(number))
            }
            None => {
                let wgsl = constant.scalar.map_or("bool", reflect::Scalar::wgsl);
                let message = format!(
                    "the constant `{}` is `{wgsl}`, and what feeds it is {}",
                    constant.name,
                    shown(&scalar.value)
                );
                let at = place_of(bind, &constant.name).unwrap_or(stages.at);
                let mut diagnostic =
                    fault(Code::UNIFORM_MISMATCH, message, constant.span, "the constant").see(at, "fed here");
                if let Some(param) = self.only_param(&scalar) {
                    diagnostic = diagnostic.see(param.span, format!("a parameter of kind {}", param.kind.name()));
                }
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
        }
    }
}

/// A `bind` entry as an expression; a word of a `Choice` parameter stays a name.
fn bound_expr<'b>(bind: &'b [(Name, ast::Bound)], name: &str) -> Option<&'b Expr> {
    bind.iter().find(|(n, _)| n.value == name).and_then(|(_, bound)| match bound {
        ast::Bound::Expr(expr) => Some(expr),
        ast::Bound::View(_) => None,
    })
}

fn constant_value(value: &Value, scalar: Option<reflect::Scalar>) -> Option<f64> {
    let number = match value {
        Value::Bool(b) => f64::from(u8::from(*b)),
        other => other.as_f64()?,
    };
    match (scalar, value) {
        (None, Value::Bool(_)) => Some(number),
        (Some(reflect::Scalar::F32 | reflect::Scalar::F16), Value::Int(_) | Value::Float(_)) => Some(number),
        (Some(reflect::Scalar::U32), Value::Int(i)) => (*i >= 0).then_some(number),
        (Some(reflect::Scalar::U32), Value::Bool(_)) => Some(number),
        (Some(reflect::Scalar::I32), Value::Int(_)) => Some(number),
        _ => None,
    }
}

/// The path that an expression is, if it is nothing else.
fn path_of(expr: &Expr) -> Option<Arc<str>> {
    match &expr.kind {
        ExprKind::Name(path) => Some(path.as_str().into()),
        _ => None,
    }
}

/// Whether a value can be packed as a WGSL type (rule 13).
pub(super) fn fits(value: &UniformValue, ty: &Type) -> bool {
    match value {
        UniformValue::Known(value) => known_fits(value, ty),
        UniformValue::Live(expr) => match &expr.kind {
            ExprKind::Name(name) => live_type(name).is_none_or(|field| field_fits(field, ty)),
            // Arithmetic of live values gives numbers or vectors of them.
            _ => matches!(ty, Type::Scalar(reflect::Scalar::F32) | Type::Vector { scalar: reflect::Scalar::F32, .. }),
        },
    }
}

fn known_fits(value: &Value, ty: &Type) -> bool {
    use reflect::Scalar::{F16, F32, I32, U32};
    match (value, ty) {
        (Value::Int(i), Type::Scalar(U32)) => u32::try_from(*i).is_ok(),
        (Value::Int(i), Type::Scalar(I32)) => i32::try_from(*i).is_ok(),
        (Value::Int(_) | Value::Float(_), Type::Scalar(F32 | F16)) => true,
        (Value::Bool(_), Type::Scalar(U32)) => true,
        // A colour of three channels is opaque where four are wanted.
        (Value::Vector(v), Type::Vector { components, scalar }) => {
            let length = v.len() as u32 == *components || (v.len() == 3 && *components == 4);
            let scalar = Type::Scalar(*scalar);
            length && v.iter().all(|x| known_fits(&x, &scalar))
        }
        _ => false,
    }
}

/// The type of a live name: `time`, or a field of a camera, light or pointer.
fn live_type(name: &str) -> Option<FieldType> {
    let field = name.rsplit('.').next()?;
    let tables = if name.contains('.') { [fields::CAMERA, fields::LIGHT, fields::POINTER] } else { [fields::FRAME; 3] };
    tables.iter().find_map(|table| table.iter().find(|(known, _)| *known == field).map(|(_, ty)| *ty))
}

fn field_fits(field: FieldType, ty: &Type) -> bool {
    use reflect::Scalar::{F32, I32, U32};
    match (field, ty) {
        (FieldType::Int, Type::Scalar(F32 | I32 | U32)) | (FieldType::Float, Type::Scalar(F32)) => true,
        (FieldType::Vec2, Type::Vector { components, scalar: F32 }) => *components == 2,
        (FieldType::Vec3, Type::Vector { components, scalar: F32 }) => matches!(components, 3 | 4),
        (FieldType::Mat4, Type::Matrix { columns: 4, rows: 4, scalar: F32 }) => true,
        _ => false,
    }
}
