//! Validation errors. naga's spans are good and its labels useless, so the texts are made here:
//! own words where people meet the error often, else naga's, cleaned.

use naga::common::wgsl::TypeContext as _;
use naga::valid::{Disalignment, GlobalVariableError, TypeError, ValidationError, WidthError};
use naga::{Handle, Module, TypeInner, WithSpan};

use super::{error, finish, sentence};
use crate::diagnostic::{Diagnostic, Span};
use crate::shader::assemble::Assembled;

/// What is said of an error.
pub(super) struct Said {
    pub message: String,
    /// Said at the place.
    pub label: String,
    /// A better place than those that naga names.
    pub at: Option<Span>,
    /// Another place, and what is said there.
    pub also: Option<(Span, &'static str)>,
    pub hint: Option<&'static str>,
}

impl Said {
    pub fn new(message: impl Into<String>, label: impl Into<String>) -> Self {
        Self { message: message.into(), label: label.into(), at: None, also: None, hint: None }
    }

    /// What naga says.
    pub fn naga(error: &dyn std::error::Error) -> Self {
        Self::new(sentence(error), "this is not valid")
    }

    /// What needs a feature that is not in the list of those that a graph can need.
    pub fn out_of_reach(capability: naga::valid::Capabilities) -> Self {
        let names = capability.iter_names().map(|(name, _)| name.to_lowercase().replace('_', " "));
        let names: Vec<String> = names.collect();
        Self::new(format!("it takes a feature that graphs cannot ask for: {}", names.join(", ")), "not available")
    }

    pub fn hint(self, hint: &'static str) -> Self {
        Self { hint: Some(hint), ..self }
    }

    pub fn at(self, at: Option<Span>) -> Self {
        Self { at: at.or(self.at), ..self }
    }

    pub fn also(self, span: Option<Span>, text: &'static str) -> Self {
        Self { also: span.map(|span| (span, text)), ..self }
    }

    pub fn of(self, item: &str) -> Self {
        Self { message: format!("{item}: {}", self.message), ..self }
    }
}

pub(in crate::shader) fn validation_error(
    found: &WithSpan<ValidationError>,
    module: &Module,
    assembled: &Assembled,
) -> Diagnostic {
    let sayer = Sayer { module, assembled };
    let (said, inside) = sayer.module_error(found.as_inner());
    let place = said.at.or_else(|| sayer.place(found)).or(inside.map(|(span, _)| span));
    let mut diagnostic = error(said.message).at(place.unwrap_or_else(|| assembled.map.start()), said.label);
    for (span, text) in said.also.into_iter().chain(inside) {
        if diagnostic.labels.iter().all(|label| label.span != span) {
            diagnostic = diagnostic.see(span, text);
        }
    }
    if let Some(hint) = said.hint {
        diagnostic = diagnostic.hint(hint);
    }
    finish(diagnostic, assembled)
}

pub(super) struct Sayer<'a> {
    pub module: &'a Module,
    assembled: &'a Assembled,
}

impl Sayer<'_> {
    pub fn span(&self, whole: naga::Span) -> Option<Span> {
        self.assembled.map.span(whole)
    }

    /// The innermost place that naga names, but for whole functions and the like, for which
    /// the place of the name does better.
    fn place(&self, found: &WithSpan<ValidationError>) -> Option<Span> {
        let items = ["ir::Function ", "ir::GlobalVariable ", "ir::Type ", "ir::Override ", "ir::Constant "];
        let mut places = found.spans().filter(|(_, what)| !items.iter().any(|item| what.contains(item)));
        places.find_map(|(span, _)| self.span(*span))
    }

    /// Where a name at module scope is declared.
    pub fn named(&self, name: &str) -> Option<Span> {
        self.assembled.declarations.name(name)
    }

    pub fn declared(&self, name: &str) -> Option<&crate::shader::declare::Function> {
        self.assembled.declarations.functions.get(name)
    }

    /// Where a struct's member is declared.
    pub fn member(&self, of: Handle<naga::Type>, member: &naga::StructMember) -> Option<Span> {
        let name = self.module.types[of].name.as_deref()?;
        self.assembled.declarations.member(name, member.name.as_deref()?)
    }

    /// The members of a struct.
    pub fn members(&self, of: Handle<naga::Type>) -> &[naga::StructMember] {
        match &self.module.types[of].inner {
            TypeInner::Struct { members, .. } => members,
            _ => &[],
        }
    }

    pub fn type_name(&self, handle: Handle<naga::Type>) -> String {
        self.module.to_ctx().type_to_string(handle)
    }

    /// What is said, and the item in which the error is.
    fn module_error(&self, found: &ValidationError) -> (Said, Option<(Span, &'static str)>) {
        let named = |name: &str, text| self.named(name).map(|span| (span, text));
        match found {
            ValidationError::Function { handle, name, source } => {
                let said = self.function(&self.module.functions[*handle], source);
                (said.of(&format!("function `{name}`")), named(name, "in this function"))
            }
            ValidationError::EntryPoint { stage, name, source } => {
                let mut points = self.module.entry_points.iter();
                let said = match points.find(|p| p.name == *name && p.stage == *stage) {
                    Some(point) => self.entry_point(point, source),
                    None => Said::naga(source),
                };
                (said.of(&format!("entry point `{name}`")), named(name, "in this entry point"))
            }
            ValidationError::GlobalVariable { handle, name, source } => {
                let said = self.variable(&self.module.global_variables[*handle], source);
                (said.of(&format!("variable `{name}`")), named(name, "this variable"))
            }
            ValidationError::Type { handle, name, source } => {
                let inside = named(name, "in this type").or_else(|| self.variable_of(*handle));
                (self.type_error(*handle, source).of(&format!("type `{}`", self.type_name(*handle))), inside)
            }
            ValidationError::Constant { name, source, .. } => {
                (Said::naga(source).of(&format!("constant `{name}`")), named(name, "this constant"))
            }
            ValidationError::Override { name, source, .. } => {
                (Said::naga(source).of(&format!("override `{name}`")), named(name, "this override"))
            }
            ValidationError::ConstExpression { source, .. } => (Said::naga(source), None),
            other => (Said::naga(other), None),
        }
    }

    /// A variable that has a type which is written nowhere else.
    fn variable_of(&self, ty: Handle<naga::Type>) -> Option<(Span, &'static str)> {
        let mut variables = self.module.global_variables.iter().map(|(_, variable)| variable);
        let name = variables.find(|variable| variable.ty == ty)?.name.as_deref()?;
        Some((self.named(name)?, "of this type"))
    }

    fn variable(&self, variable: &naga::GlobalVariable, found: &GlobalVariableError) -> Said {
        let ty = self.type_name(variable.ty);
        match found {
            GlobalVariableError::Alignment(_, within, Disalignment::NonHostShareable) => {
                let bools = self.module.types.iter().filter(|(_, ty)| is_bool(&ty.inner)).map(|(handle, _)| handle);
                let found = bools.filter_map(|ty| Some((ty, self.member_of_type(variable.ty, ty)?))).next();
                let (ty, place) = found.map_or((*within, None), |(ty, place)| (ty, Some(place)));
                Said::new(format!("a buffer cannot hold `{}`", self.type_name(ty)), "not in a buffer")
                    .at(place)
                    .hint("write `u32` in place of `bool`")
            }
            GlobalVariableError::Alignment(_, within, source) => {
                let text = format!("`{}` is not laid out as uniforms must be", self.type_name(*within));
                let hint = "elements of arrays and structs in uniforms take multiples of 16 bytes: use `vec4<f32>` \
                            elements or `@align(16)`, or a storage buffer";
                Said::new(text, sentence(source)).at(self.member_of_type(variable.ty, *within)).hint(hint)
            }
            GlobalVariableError::MissingTypeFlags { .. } => {
                let text = format!("`{ty}` cannot be here: it holds what a buffer cannot, or its size is not fixed");
                Said::new(text, format!("of type `{ty}`"))
                    .hint("write `u32` in place of `bool`; a runtime-sized array stands at the end of a storage buffer")
            }
            GlobalVariableError::UnsupportedCapability(capability) => Said::out_of_reach(*capability),
            other => Said::naga(other),
        }
    }

    /// The declaration of the member, at any depth, that has a type.
    fn member_of_type(&self, of: Handle<naga::Type>, ty: Handle<naga::Type>) -> Option<Span> {
        if let TypeInner::Array { base, .. } = self.module.types[of].inner {
            return self.member_of_type(base, ty);
        }
        let mut members = self.members(of).iter();
        members.find_map(|member| match member.ty == ty {
            true => self.member(of, member),
            false => self.member_of_type(member.ty, ty),
        })
    }

    fn type_error(&self, handle: Handle<naga::Type>, found: &TypeError) -> Said {
        match found {
            TypeError::MissingCapability(capability) => Said::out_of_reach(*capability),
            TypeError::WidthError(WidthError::MissingCapability { name, .. }) => {
                Said::new(format!("`{name}` takes a feature that graphs cannot ask for"), "not available")
            }
            TypeError::InvalidDynamicArray(name, _) => {
                let member = self.members(handle).iter().find(|m| m.name.as_ref() == Some(name));
                Said::new(format!("only the last member may be a runtime-sized array, and `{name}` is not"), "not last")
                    .at(member.and_then(|member| self.member(handle, member)))
            }
            other => Said::naga(other),
        }
    }
}

fn is_bool(inner: &TypeInner) -> bool {
    match inner {
        TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. } => scalar.kind == naga::ScalarKind::Bool,
        _ => false,
    }
}
