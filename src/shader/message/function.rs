//! Validation errors inside functions.

use naga::valid::{CallError, ExpressionError, FunctionError};
use naga::{Block, Expression, Function, Handle, Statement};

use super::validation::{Said, Sayer};
use crate::diagnostic::Span;

const CONVERT: &str = "WGSL converts nothing by itself: write `f32(x)`, `u32(x)`, `vec3<f32>(x)`";
const WRITABLE: &str = "a storage buffer that is written is declared `var<storage, read_write>`";

impl Sayer<'_> {
    pub(super) fn function(&self, function: &Function, found: &FunctionError) -> Said {
        match found {
            FunctionError::Expression { handle, source } => self.expression(function, *handle, source),
            FunctionError::InvalidReturnType { expression, .. } => self.wrong_return(function, *expression),
            FunctionError::InvalidStoreTypes { .. } => {
                Said::new("the value's type is not that of the place it is stored in", "of another type").hint(CONVERT)
            }
            FunctionError::InvalidStorePointer(_) => {
                Said::new("the place to store in cannot be written", "not writable").hint(WRITABLE)
            }
            FunctionError::InvalidImageStore(ExpressionError::ExpectedGlobalVariable) => {
                let is_store = |statement: &Statement| match statement {
                    Statement::ImageStore { image, .. } => {
                        !matches!(function.expressions[*image], Expression::GlobalVariable(_))
                    }
                    _ => false,
                };
                Said::new("a storage texture that is written cannot be an argument", "written here")
                    .at(self.statement(&function.body, &is_store))
                    .hint("name the variable itself in `textureStore`")
            }
            FunctionError::InvalidCall { function: callee, error } => self.call(function, *callee, error),
            FunctionError::MissingCapability(capability) => Said::out_of_reach(*capability),
            other => Said::naga(other),
        }
    }

    /// Where the first statement of a kind stands.
    fn statement(&self, block: &Block, is_meant: &dyn Fn(&Statement) -> bool) -> Option<Span> {
        block.span_iter().find_map(|(statement, span)| match statement {
            found if is_meant(found) => self.span(*span),
            Statement::Block(inner) => self.statement(inner, is_meant),
            Statement::If { accept, reject, .. } => {
                self.statement(accept, is_meant).or_else(|| self.statement(reject, is_meant))
            }
            Statement::Switch { cases, .. } => cases.iter().find_map(|case| self.statement(&case.body, is_meant)),
            Statement::Loop { body, continuing, .. } => {
                self.statement(body, is_meant).or_else(|| self.statement(continuing, is_meant))
            }
            _ => None,
        })
    }

    fn wrong_return(&self, function: &Function, expression: Option<Handle<Expression>>) -> Said {
        // The expression's own place may be the declaration of an argument.
        let is_it = |statement: &Statement| matches!(statement, Statement::Return { value } if *value == expression);
        let place = expression.and_then(|_| self.statement(&function.body, &is_it));
        let declared = function.result.as_ref().map(|result| self.type_name(result.ty));
        match (declared, expression) {
            (Some(ty), Some(_)) => {
                let text = format!("the returned value is not of the declared type `{ty}`");
                Said::new(text, format!("expected `{ty}`")).at(place).hint(CONVERT)
            }
            (Some(ty), None) => {
                Said::new(format!("it must return a `{ty}` on every path"), "a path ends without `return`")
            }
            (None, _) => Said::new("it returns a value but declares none", "returned here")
                .at(place)
                .hint("declare the type: `fn name() -> type`"),
        }
    }

    fn expression(&self, function: &Function, handle: Handle<Expression>, found: &ExpressionError) -> Said {
        match found {
            ExpressionError::InvalidBinaryOperandTypes { op, lhs_type, rhs_type, .. } => {
                let (left, right) = (self.inner_name(lhs_type), self.inner_name(rhs_type));
                let text = format!("`{}` does not work on {left} and {right}", operator(*op));
                Said::new(text, "these types do not go together").hint(CONVERT)
            }
            ExpressionError::MissingCapabilities(capability) => Said::out_of_reach(*capability),
            ExpressionError::InvalidImageCoordinateType(..) => {
                Said::new("the coordinate's type does not fit the texture's dimension", "not its coordinate").hint(
                    "sampling takes floats, `textureLoad` and `textureStore` take integers, as many as dimensions",
                )
            }
            ExpressionError::ComparisonSamplingMismatch { sampler: true, has_ref: false, .. } => {
                Said::new("a comparison sampler only works with `textureSampleCompare`", "sampled without comparing")
            }
            ExpressionError::ComparisonSamplingMismatch { .. } => {
                Said::new("comparing takes a depth texture and a comparison sampler", "these do not go together")
            }
            other => match &function.expressions[handle] {
                Expression::Math { fun, .. } => {
                    Said::naga(other).of(&format!("`{}`", format!("{fun:?}").to_lowercase()))
                }
                _ => Said::naga(other),
            },
        }
    }

    fn inner_name(&self, inner: &naga::TypeInner) -> String {
        let handle = self.module.types.iter().find(|(_, ty)| ty.inner == *inner).map(|(handle, _)| handle);
        handle.map_or_else(|| "a type without a name".into(), |handle| format!("`{}`", self.type_name(handle)))
    }

    fn call(&self, caller: &Function, callee: Handle<Function>, found: &CallError) -> Said {
        let callee = &self.module.functions[callee];
        let name = callee.name.as_deref().unwrap_or_default();
        match found {
            CallError::ArgumentCount { required, seen } => {
                let plural = |count: &usize| if *count == 1 { "" } else { "s" };
                let text = format!("`{name}` takes {required} argument{}, {seen} given", plural(required));
                Said::new(text, format!("expected {required} argument{}", plural(required)))
                    .also(self.named(name), "declared here")
            }
            CallError::ArgumentType { index, required, seen_expression } => {
                let ty = self.type_name(*required);
                let argument = callee.arguments.get(*index).and_then(|a| a.name.as_deref()).unwrap_or_default();
                let declared = self.declared(name).and_then(|d| d.arguments.get(*index)).map(|field| field.span);
                Said::new(format!("argument `{argument}` of `{name}` must be `{ty}`"), format!("expected `{ty}`"))
                    .at(self.span(caller.expressions.get_span(*seen_expression)))
                    .also(declared, "declared here")
                    .hint(CONVERT)
            }
            other => Said::naga(other).of(&format!("call of `{name}`")),
        }
    }
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
