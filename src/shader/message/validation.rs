//! Validation errors. naga's spans are good and its labels useless, so the texts are made here:
//! own words where people meet the error often, else naga's, cleaned.

use naga::common::wgsl::TypeContext as _;
use naga::valid::{
    CallError, EntryPointError, ExpressionError, FunctionError, GlobalVariableError, TypeError, ValidationError,
    VaryingError,
};
use naga::{Arena, Expression, Handle, Module, WithSpan};

use super::{error, finish, sentence, sentence_of};
use crate::diagnostic::{Diagnostic, Span};
use crate::shader::assemble::Assembled;

/// What is said of an error.
struct Said {
    message: String,
    /// At the place that naga points at.
    label: String,
    hint: Option<&'static str>,
}

impl Said {
    fn new(message: impl Into<String>, label: impl Into<String>) -> Self {
        Self { message: message.into(), label: label.into(), hint: None }
    }

    fn hint(mut self, hint: &'static str) -> Self {
        self.hint = Some(hint);
        self
    }
}

pub(in crate::shader) fn validation_error(
    found: &WithSpan<ValidationError>,
    module: &Module,
    assembled: &Assembled,
) -> Diagnostic {
    let sayer = Sayer { module, assembled };
    let (said, inside) = sayer.module_error(found.as_inner());
    let mut diagnostic = error(said.message);
    let mut places = sayer.places(found);
    places.retain(|place| Some(*place) != inside);
    match (places.first(), inside) {
        (Some(first), _) => diagnostic = diagnostic.at(*first, said.label),
        (None, Some(inside)) => diagnostic = diagnostic.at(inside, said.label),
        (None, None) => diagnostic = diagnostic.at(assembled.map.start(), said.label),
    }
    for place in places.iter().skip(1) {
        diagnostic = diagnostic.see(*place, "and this");
    }
    if let (Some(inside), true) = (inside, diagnostic.labels.iter().all(|l| Some(l.span) != inside)) {
        diagnostic = diagnostic.see(inside, "in this");
    }
    if let Some(hint) = said.hint {
        diagnostic = diagnostic.hint(hint);
    }
    finish(diagnostic, assembled)
}

struct Sayer<'a> {
    module: &'a Module,
    assembled: &'a Assembled,
}

impl Sayer<'_> {
    /// The places that naga names, innermost first, without whole functions and the like, for
    /// which the place of the name does better.
    fn places(&self, found: &WithSpan<ValidationError>) -> Vec<Span> {
        let mut places = Vec::new();
        for (span, what) in found.spans() {
            let is_item = ["ir::Function ", "ir::GlobalVariable ", "ir::Type ", "ir::Override ", "ir::Constant "];
            if is_item.iter().any(|item| what.contains(item)) {
                continue;
            }
            let place = self.assembled.map.span(*span);
            if let Some(place) = place.filter(|place| !places.contains(place)) {
                places.push(place);
            }
        }
        places
    }

    fn named(&self, name: &str) -> Option<Span> {
        self.assembled.declarations.name(name)
    }

    /// What is said, and the name of the item in which the error is.
    fn module_error(&self, found: &ValidationError) -> (Said, Option<Span>) {
        match found {
            ValidationError::Function { handle, name, source } => {
                let function = &self.module.functions[*handle];
                (self.function(&format!("function `{name}`"), function, source), self.named(name))
            }
            ValidationError::EntryPoint { stage, name, source } => {
                let point = self.module.entry_points.iter().find(|p| p.name == *name && p.stage == *stage);
                let item = format!("entry point `{name}`");
                let said = match (source, point) {
                    (EntryPointError::Function(source), Some(point)) => self.function(&item, &point.function, source),
                    _ => self.entry_point(&item, source, point),
                };
                (said, self.named(name))
            }
            ValidationError::GlobalVariable { handle, name, source } => {
                (self.variable(name, &self.module.global_variables[*handle], source), self.named(name))
            }
            ValidationError::Type { handle, name, source } => {
                let shown = self.type_name(*handle);
                let inside = self.named(name).or_else(|| self.assembled.map.span(self.module.types.get_span(*handle)));
                (self.type_error(&shown, source), inside)
            }
            ValidationError::Constant { name, source, .. } => {
                (Said::new(format!("constant `{name}`: {}", sentence(source)), "in this constant"), self.named(name))
            }
            ValidationError::Override { name, source, .. } => {
                (Said::new(format!("override `{name}`: {}", sentence(source)), "in this override"), self.named(name))
            }
            ValidationError::ConstExpression { source, .. } => {
                (Said::new(format!("constant expression: {}", sentence(source)), "this cannot be evaluated"), None)
            }
            ValidationError::ArraySizeError { .. } => {
                (Said::new("an array's size must be greater than zero", "this is not"), None)
            }
            other => (Said::new(sentence(other), "here"), None),
        }
    }

    fn type_name(&self, handle: Handle<naga::Type>) -> String {
        self.module.to_ctx().type_to_string(handle)
    }

    fn function(&self, item: &str, function: &naga::Function, found: &FunctionError) -> Said {
        let said = match found {
            FunctionError::Expression { handle, source } => self.expression(&function.expressions, *handle, source),
            FunctionError::InvalidReturnType { expression, .. } => self.wrong_return(function, *expression),
            FunctionError::InvalidStoreTypes { .. } => {
                Said::new("the value's type is not that of the place it is stored in", "of another type")
            }
            FunctionError::InvalidStorePointer(_) => {
                Said::new("the place to store in cannot be written", "not writable")
                    .hint("a storage buffer that is written is declared `var<storage, read_write>`")
            }
            FunctionError::InvalidStoreValue { actual_ty, expected_ty, .. } => {
                let texel = self.inner_name(expected_ty);
                let text = format!("the texture stores `{texel}`, the value is `{}`", self.inner_name(actual_ty));
                Said::new(text, format!("expected `{texel}`"))
            }
            FunctionError::InvalidCall { function, error } => self.call(*function, error),
            FunctionError::NonUniformControlFlow(..) => Said::new(
                "this must run in uniform control flow, which depends here on a value that differs between threads",
                "not uniform here",
            )
            .hint("move it out of the condition, or out of reach of the early return"),
            FunctionError::InvalidImageStore(ExpressionError::ExpectedGlobalVariable) => {
                Said::new("a storage texture that is written cannot be an argument", "an argument")
                    .hint("name the variable itself in `textureStore`")
            }
            FunctionError::MissingCapability(capability) => capability_missing(*capability),
            other => Said::new(sentence(other), "this is not valid"),
        };
        Said { message: format!("{item}: {}", said.message), ..said }
    }

    fn inner_name(&self, inner: &naga::TypeInner) -> String {
        let handle = self.module.types.iter().find(|(_, ty)| ty.inner == *inner).map(|(handle, _)| handle);
        handle.map_or_else(|| sentence_of(&format!("{inner:?}")), |handle| self.type_name(handle))
    }

    fn wrong_return(&self, function: &naga::Function, expression: Option<Handle<Expression>>) -> Said {
        let declared = function.result.as_ref().map(|result| self.type_name(result.ty));
        match (declared, expression) {
            (Some(ty), Some(_)) => {
                Said::new(format!("the returned value is not of the declared type `{ty}`"), format!("expected `{ty}`"))
            }
            (Some(ty), None) => {
                Said::new(format!("it must return a `{ty}` on every path"), "a path ends without `return`")
            }
            (None, _) => Said::new("it returns a value but declares none", "returned here")
                .hint("declare the type: `fn name() -> type`"),
        }
    }

    fn expression(&self, arena: &Arena<Expression>, handle: Handle<Expression>, found: &ExpressionError) -> Said {
        match found {
            ExpressionError::InvalidBinaryOperandTypes { op, lhs_type, rhs_type, .. } => {
                let (left, right) = (self.inner_name(lhs_type), self.inner_name(rhs_type));
                let text = format!("`{}` does not work on `{left}` and `{right}`", operator(*op));
                Said::new(text, "these types do not go together")
                    .hint("WGSL converts nothing by itself: write `f32(x)`, `u32(x)`, `vec3<f32>(x)`")
            }
            ExpressionError::MissingCapabilities(capability) => capability_missing(*capability),
            ExpressionError::InvalidImageCoordinateType(..) => {
                Said::new("the coordinate's type does not fit the texture's dimension", "not its coordinate")
                    .hint("sampling takes floats, `textureLoad` and `textureStore` integers, as many as dimensions")
            }
            ExpressionError::ComparisonSamplingMismatch { sampler: true, has_ref: false, .. } => {
                Said::new("a comparison sampler only works with `textureSampleCompare`", "sampled without comparing")
            }
            ExpressionError::ComparisonSamplingMismatch { .. } => {
                Said::new("comparing takes a depth texture and a comparison sampler", "these do not go together")
            }
            ExpressionError::DivideByZero => Said::new("division by zero", "the divisor is zero"),
            other => {
                let shown = match &arena[handle] {
                    Expression::Math { fun, .. } => format!("`{}`: ", format!("{fun:?}").to_lowercase()),
                    _ => String::new(),
                };
                Said::new(format!("{shown}{}", sentence(other)), "this is not valid")
            }
        }
    }

    fn call(&self, callee: Handle<naga::Function>, found: &CallError) -> Said {
        let callee = &self.module.functions[callee];
        let name = callee.name.as_deref().unwrap_or_default();
        match found {
            CallError::ArgumentCount { required, seen } => {
                let text = format!("`{name}` takes {required} arguments, {seen} are given");
                Said::new(text, format!("expected {required} arguments"))
            }
            CallError::ArgumentType { index, required, .. } => {
                let ty = self.type_name(*required);
                let argument = callee.arguments.get(*index).and_then(|a| a.name.as_deref()).unwrap_or_default();
                Said::new(format!("argument `{argument}` of `{name}` must be `{ty}`"), format!("expected `{ty}`"))
                    .hint("WGSL converts nothing by itself: write `f32(x)`, `u32(x)`, `vec3<f32>(x)`")
            }
            other => Said::new(format!("call of `{name}`: {}", sentence(other)), "this call is not valid"),
        }
    }

    fn entry_point(&self, item: &str, found: &EntryPointError, point: Option<&naga::EntryPoint>) -> Said {
        let said = match found {
            EntryPointError::Conflict => Said::new("two entry points of one stage have this name", "one of them"),
            EntryPointError::MissingVertexOutputPosition => {
                Said::new("a vertex stage must return `@builtin(position)`", "returns no position")
            }
            EntryPointError::OutOfRangeWorkgroupSize => {
                Said::new("each workgroup size must lie between 1 and 16384", "its `@workgroup_size` does not")
            }
            EntryPointError::ForbiddenStageOperations => {
                Said::new("it uses operations that its stage does not have", "of the wrong stage for them")
                    .hint("derivatives and `textureSample` belong to fragment stages, barriers to compute stages")
            }
            EntryPointError::InvalidGlobalUsage(handle, _) => self.wrong_usage(*handle),
            EntryPointError::Argument(index, source) => {
                let name = point.and_then(|p| p.function.arguments.get(*index as usize)?.name.as_deref());
                let said = self.varying(source);
                let message = format!("argument `{}`: {}", name.unwrap_or_default(), said.message);
                Said { message, ..said }
            }
            EntryPointError::Result(source) => {
                let said = self.varying(source);
                Said { message: format!("what it returns: {}", said.message), ..said }
            }
            EntryPointError::UnsupportedCapability(capability) => capability_missing(*capability),
            other => Said::new(sentence(other), "this is not valid"),
        };
        Said { message: format!("{item}: {}", said.message), ..said }
    }

    fn wrong_usage(&self, handle: Handle<naga::GlobalVariable>) -> Said {
        let variable = &self.module.global_variables[handle];
        let name = variable.name.as_deref().unwrap_or_default();
        let hint = match variable.space {
            naga::AddressSpace::Storage { .. } => {
                "a storage buffer that is written is declared `var<storage, read_write>`"
            }
            _ => {
                "a storage texture says `read`, `write` or `read_write`; textures that are passed as arguments count as read"
            }
        };
        Said::new(format!("it uses `{name}` in a way that its declaration does not allow"), "used here").hint(hint)
    }

    fn varying(&self, found: &VaryingError) -> Said {
        match found {
            VaryingError::MissingBinding => {
                Said::new("neither `@location` nor `@builtin` is given", "needs one of them")
            }
            VaryingError::MemberMissingBinding(index) => {
                Said::new(format!("member {index} has neither `@location` nor `@builtin`"), "needs one of them")
            }
            VaryingError::InvalidInterpolationForInteger => {
                Said::new("integers must be `@interpolate(flat)`", "not flat")
            }
            VaryingError::BindingCollision { location } => {
                Said::new(format!("`@location({location})` is given twice"), "here")
            }
            VaryingError::NotIOShareableType(ty) => {
                let text =
                    format!("`{}` cannot pass between stages, only numbers and vectors can", self.type_name(*ty));
                Said::new(text, "here")
            }
            VaryingError::UnsupportedCapability(capability) => capability_missing(*capability),
            other => Said::new(sentence(other), "this is not valid"),
        }
    }

    fn variable(&self, name: &str, variable: &naga::GlobalVariable, found: &GlobalVariableError) -> Said {
        let item = format!("variable `{name}`");
        let ty = self.type_name(variable.ty);
        let said = match found {
            GlobalVariableError::Alignment(_, within, source) => Said::new(
                format!("`{}` has not the layout that a uniform must have: {}", self.type_name(*within), sentence(source)),
                format!("holds `{}`", self.type_name(*within)),
            )
            .hint("arrays in uniforms have elements of 16 bytes each: use `vec4<f32>` elements, or a storage buffer"),
            GlobalVariableError::MissingTypeFlags { .. } => Said::new(
                format!("`{ty}` cannot be there: it holds something that memory shared with the CPU cannot, or has no fixed size"),
                format!("`{ty}`"),
            )
            .hint("`bool` cannot be in buffers, write `u32`; a runtime-sized array belongs to a storage buffer, at its end"),
            GlobalVariableError::UnsupportedCapability(capability) => capability_missing(*capability),
            other => Said::new(sentence(other), "this is not valid"),
        };
        Said { message: format!("{item}: {}", said.message), ..said }
    }

    fn type_error(&self, name: &str, found: &TypeError) -> Said {
        let said = match found {
            TypeError::MissingCapability(capability) => capability_missing(*capability),
            other => Said::new(sentence(other), "this is not valid"),
        };
        Said { message: format!("type `{name}`: {}", said.message), ..said }
    }
}

fn capability_missing(capability: naga::valid::Capabilities) -> Said {
    let names: Vec<String> = capability.iter_names().map(|(name, _)| name.to_lowercase().replace('_', " ")).collect();
    Said::new(format!("it takes a feature that graphs cannot ask for: {}", names.join(", ")), "not available")
}

fn operator(op: naga::BinaryOperator) -> &'static str {
    use naga::BinaryOperator as Op;
    match op {
        Op::Add => "+",
        Op::Subtract => "-",
        Op::Multiply => "*",
        Op::Divide => "/",
        Op::Modulo => "%",
        Op::Equal => "==",
        Op::NotEqual => "!=",
        Op::Less => "<",
        Op::LessEqual => "<=",
        Op::Greater => ">",
        Op::GreaterEqual => ">=",
        Op::And => "&",
        Op::ExclusiveOr => "^",
        Op::InclusiveOr => "|",
        Op::LogicalAnd => "&&",
        Op::LogicalOr => "||",
        Op::ShiftLeft => "<<",
        Op::ShiftRight => ">>",
    }
}
