//! Validation errors of entry points and what passes between stages.

use naga::valid::{EntryPointError, GlobalUse, VaryingError};
use naga::{Binding, EntryPoint, Expression, Handle, SampleLevel, TypeInner};

use super::validation::{Said, Sayer};
use crate::diagnostic::Span;

impl Sayer<'_> {
    pub(super) fn entry_point(&self, point: &EntryPoint, found: &EntryPointError) -> Said {
        match found {
            EntryPointError::Function(source) => self.function(&point.function, source),
            EntryPointError::MissingVertexOutputPosition => {
                Said::new("a vertex stage must return `@builtin(position)`", "returns no position")
                    .at(self.declared(&point.name).and_then(|d| d.result))
            }
            EntryPointError::OutOfRangeWorkgroupSize => {
                Said::new("each workgroup size must lie between 1 and 16384", "its `@workgroup_size` does not")
            }
            EntryPointError::ForbiddenStageOperations => {
                Said::new("it uses operations that its stage does not have", "not in this stage")
                    .at(self.expression_anywhere(point, &|e| is_fragment_only(e)))
                    .hint("derivatives and `textureSample` belong to fragment stages, barriers to compute stages")
            }
            EntryPointError::InvalidGlobalUsage(handle, usage) => self.wrong_usage(point, *handle, *usage),
            EntryPointError::Argument(index, source) => {
                let Some(argument) = point.function.arguments.get(*index as usize) else {
                    return Said::naga(source);
                };
                let fields = self.declared(&point.name).map(|d| d.arguments.as_slice()).unwrap_or_default();
                let name = argument.name.as_deref().unwrap_or_default();
                self.varying(argument.ty, source)
                    .or_at(fields.get(*index as usize).map(|field| field.span))
                    .of(&format!("argument `{name}`"))
            }
            EntryPointError::Result(source) => match &point.function.result {
                Some(result) => {
                    let declared = self.declared(&point.name).and_then(|d| d.result);
                    self.varying(result.ty, source).or_at(declared).of("what it returns")
                }
                None => Said::naga(source),
            },
            EntryPointError::UnsupportedCapability(capability) => Said::out_of_reach(*capability),
            other => Said::naga(other),
        }
    }

    /// Where the first expression of a kind stands: in the entry point, else in any function.
    fn expression_anywhere(&self, point: &EntryPoint, is_meant: &dyn Fn(&Expression) -> bool) -> Option<Span> {
        let functions = self.module.functions.iter().map(|(_, function)| function);
        std::iter::once(&point.function).chain(functions).find_map(|function| {
            let (handle, _) = function.expressions.iter().find(|(_, expression)| is_meant(expression))?;
            self.span(function.expressions.get_span(handle))
        })
    }

    fn wrong_usage(&self, point: &EntryPoint, handle: Handle<naga::GlobalVariable>, usage: GlobalUse) -> Said {
        let name = self.module.global_variables[handle].name.as_deref().unwrap_or_default();
        let names_it = |e: &Expression| matches!(e, Expression::GlobalVariable(found) if *found == handle);
        let (wants, hint) = match usage {
            usage if usage.contains(GlobalUse::READ) => (
                "reads",
                "a storage texture that is read is declared `read` or `read_write`; one that is passed as an argument counts as read",
            ),
            usage if usage.contains(GlobalUse::WRITE) => {
                ("writes", "a storage texture that is written is declared `write` or `read_write`")
            }
            _ => ("uses atomics on", "a storage texture with atomics is declared `atomic`"),
        };
        Said::new(format!("it {wants} `{name}`, which its declaration does not allow"), "named here")
            .at(self.expression_anywhere(point, &names_it))
            .also(self.named(name), "declared here")
            .hint(hint)
    }

    fn varying(&self, ty: Handle<naga::Type>, found: &VaryingError) -> Said {
        let member = |is_meant: &dyn Fn(&naga::StructMember) -> bool| {
            let member = self.members(ty).iter().rfind(|member| is_meant(member));
            member.and_then(|member| self.member(ty, member))
        };
        match found {
            VaryingError::MissingBinding => {
                Said::new("neither `@location` nor `@builtin` is given", "needs one of them")
            }
            VaryingError::MemberMissingBinding(index) => {
                let found = self.members(ty).get(*index as usize);
                let name = found.and_then(|member| member.name.as_deref()).unwrap_or_default();
                Said::new(format!("member `{name}` has neither `@location` nor `@builtin`"), "needs one of them")
                    .at(found.and_then(|member| self.member(ty, member)))
            }
            VaryingError::InvalidInterpolationForInteger => {
                Said::new("integers must be `@interpolate(flat)`", "not flat")
                    .at(member(&|m| self.is_sloped_integer(m)))
            }
            VaryingError::BindingCollision { location } => {
                let is_it = |m: &naga::StructMember| matches!(m.binding, Some(Binding::Location { location: found, .. }) if found == *location);
                Said::new(format!("`@location({location})` is given twice"), "given again").at(member(&is_it))
            }
            VaryingError::NotIOShareableType(found) => {
                let text =
                    format!("`{}` cannot pass between stages, only numbers and vectors can", self.type_name(*found));
                Said::new(text, "not a number or vector").at(member(&|m| m.ty == *found))
            }
            VaryingError::UnsupportedCapability(capability) => Said::out_of_reach(*capability),
            other => Said::naga(other),
        }
    }

    /// An integer with an interpolation other than flat.
    fn is_sloped_integer(&self, member: &naga::StructMember) -> bool {
        let is_integer = matches!(
            self.module.types[member.ty].inner,
            TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. }
                if matches!(scalar.kind, naga::ScalarKind::Sint | naga::ScalarKind::Uint)
        );
        let flat = Some(naga::Interpolation::Flat);
        is_integer && matches!(member.binding, Some(Binding::Location { interpolation, .. }) if interpolation != flat)
    }
}

impl Said {
    /// A place for want of a better one.
    fn or_at(self, at: Option<Span>) -> Self {
        Self { at: self.at.or(at), ..self }
    }
}

fn is_fragment_only(expression: &Expression) -> bool {
    match expression {
        Expression::Derivative { .. } => true,
        Expression::ImageSample { level, .. } => matches!(level, SampleLevel::Auto | SampleLevel::Bias(_)),
        _ => false,
    }
}
