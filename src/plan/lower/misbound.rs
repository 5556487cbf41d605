//! What is wrong between a shader's variables and what the graph feeds them.

use super::bind::{Feed, Stages};
use super::names::Entity;
use super::{Lowering, ScopeId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Label, Span};
use crate::format::{self, SampleKind};
use crate::graph::expr::ExprKind;
use crate::graph::model::{self as ast, Name};
use crate::plan::model::ObjectRef;
use crate::shader::reflect::{GlobalKind, TextureDimension, Type};

impl Lowering<'_> {
    /// An optional input that a shader takes as if it were always there.
    pub(super) fn absent_fed_to(&self, s: ScopeId, place: &Feed<'_>) -> Box<Diagnostic> {
        let bound = place.bind.iter().find(|(name, _)| *name.value == *place.global().name);
        let (name, span) = match bound {
            Some((_, ast::Bound::View(view))) => (view.of.value.as_str(), view.of.span),
            Some((_, ast::Bound::Expr(expr))) => match &expr.kind {
                ExprKind::Name(path) => (path.as_str(), expr.span),
                _ => (&*place.global().name, place.at),
            },
            None => (&*place.global().name, place.at),
        };
        let mut diagnostic = self.absent_here(s, name, span);
        diagnostic
            .labels
            .insert(1, Label { span: place.global().span, text: "the shader's variable".into(), primary: false });
        diagnostic
    }

    pub(super) fn unbound(&mut self, s: ScopeId, place: &Feed<'_>) -> Box<Diagnostic> {
        let global = place.wanted.global;
        let names: Vec<String> = self.visible(s).into_iter().map(|name| name.replace('.', "_")).collect();
        let message = format!("nothing feeds the shader's `{}`, {}", global.name, describe(&global.kind));
        let diagnostic = fault(Code::UNBOUND, message, global.span, "the shader's variable")
            .see(place.stages.at, "run by this pass")
            .nearest(&global.name, names.iter().map(String::as_str))
            .hint(format!("declare `{0}` in the graph, or say `bind: {{\"{0}\": \"...\"}}`", global.name));
        traced(diagnostic, &self.scopes[s].trace)
    }

    pub(super) fn mismatch(&self, s: ScopeId, place: &Feed<'_>, entity: &Entity) -> Box<Diagnostic> {
        match entity {
            Entity::Var(var) => self.mismatch_object(s, place, self.vars[*var].now),
            other => self.mismatched(s, place, &self.what(other), None),
        }
    }

    pub(super) fn mismatch_object(&self, s: ScopeId, place: &Feed<'_>, object: ObjectRef) -> Box<Diagnostic> {
        let declared = self.object(object).object.span;
        self.mismatched(s, place, &self.describe_object(object), Some(declared))
    }

    fn mismatched(&self, s: ScopeId, place: &Feed<'_>, is: &str, declared: Option<Span>) -> Box<Diagnostic> {
        let global = place.wanted.global;
        let wants = describe(&global.kind);
        let message = format!("the shader's `{}` wants {wants}, and is fed {is}", global.name);
        let mut diagnostic = fault(Code::BINDING_MISMATCH, message, place.at, is.to_owned())
            .see(global.span, format!("the shader wants {wants}"));
        if let Some(span) = declared.filter(|span| *span != place.at) {
            diagnostic = diagnostic.see(span, "declared here");
        }
        traced(diagnostic, &self.scopes[s].trace)
    }

    /// Every entry of `bind` must name something of the shader.
    pub(super) fn check_bind_names(&mut self, s: ScopeId, stages: &Stages, bind: &[(Name, ast::Bound)]) {
        if bind.is_empty() {
            return;
        }
        let mut known: Vec<&str> = Vec::new();
        for global in &stages.module.globals {
            known.push(&global.name);
            if let GlobalKind::Uniform(Type::Struct { members, .. }) = &global.kind {
                known.extend(members.iter().map(|m| &*m.name));
            }
        }
        known.extend(stages.module.overrides.iter().map(|o| o.name.as_str()));
        for (name, _) in bind {
            if !known.contains(&name.value.as_str()) {
                let message = format!("the shader has no `{}` to bind", name.value);
                let mut diagnostic = fault(Code::UNKNOWN_BINDING, message, name.span, "not in the shader")
                    .nearest(&name.value, known.iter().copied());
                if let Some((_, entry)) = stages.entries.first() {
                    diagnostic = diagnostic.see(entry.span, "in this shader");
                }
                if known.len() <= 12 {
                    let names: Vec<String> = known.iter().map(|name| (*name).to_owned()).collect();
                    diagnostic = diagnostic.hint(format!("it has {}", super::names::list(&names)));
                }
                self.diagnostics.push(*traced(diagnostic, &self.scopes[s].trace));
            }
        }
    }
}

/// What a shader's variable wants, for messages.
pub(super) fn describe(kind: &GlobalKind) -> String {
    let dimension = |d: TextureDimension| match d {
        TextureDimension::D1 => "1D",
        TextureDimension::D2 => "2D",
        TextureDimension::D2Array => "2D array",
        TextureDimension::Cube => "cube",
        TextureDimension::CubeArray => "cube array",
        TextureDimension::D3 => "3D",
    };
    match kind {
        GlobalKind::Uniform(ty) => format!("a uniform `{}`", ty.wgsl()),
        GlobalKind::Storage { ty, .. } => format!("a buffer of `{}`", ty.wgsl()),
        GlobalKind::Texture { dimension: d, multisampled, sample } => {
            let sample = match sample {
                SampleKind::Float => "floats",
                SampleKind::Sint => "signed integers",
                SampleKind::Uint => "unsigned integers",
                SampleKind::Depth => "depth",
            };
            let many = if *multisampled { " with 4 samples" } else { "" };
            format!("a {} texture of {sample}{many}", dimension(*d))
        }
        GlobalKind::StorageTexture { dimension: d, format, .. } => {
            format!("a {} storage texture of {}", dimension(*d), format::name(*format))
        }
        GlobalKind::Sampler { comparison: true } => "a comparison sampler".to_owned(),
        GlobalKind::Sampler { comparison: false } => "a sampler".to_owned(),
        GlobalKind::Other(what) => what.clone(),
    }
}
