//! Scalars: parameters, `let` names, expressions, and what each depends on.

use std::cell::RefCell;

use super::names::Entity;
use super::{CauseSet, LetState, Lowering, Result, Scalar, ScopeId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::eval::{self, Lookup};
use crate::graph::expr::{Expr, ExprKind, Function};
use crate::graph::value::Value;
use crate::plan::model::{ObjectKind, UniformValue};

/// The names of one graph instance, as the expression language asks for them. Gathers what the
/// answers depend on.
struct Names<'l, 'p> {
    lowering: RefCell<&'l mut Lowering<'p>>,
    scope: ScopeId,
    causes: RefCell<CauseSet>,
}

impl eval::Scope for Names<'_, '_> {
    fn name(&self, path: &str, span: Span) -> std::result::Result<Lookup, Diagnostic> {
        if path.starts_with('#') {
            // What statistics read of buffers.
            return Ok(Lookup::Live(Expr { kind: ExprKind::Name(path.to_owned()), span }));
        }
        if let Some(part) = self.component(path, span) {
            return part;
        }
        let mut lowering = self.lowering.borrow_mut();
        match lowering.resolve(self.scope, path, span).map_err(|d| *d)? {
            Entity::Scalar(scalar) => {
                self.causes.borrow_mut().add(&scalar.causes);
                match scalar.value {
                    UniformValue::Known(value) => Ok(Lookup::Value(value)),
                    UniformValue::Live(expr) => Ok(Lookup::Live(expr)),
                }
            }
            other => {
                let message = format!("`{path}` is {}, not a number", lowering.what(&other));
                let mut diagnostic = fault(Code::WRONG_KIND, message, span, "not a number");
                if let Entity::Var(var) = other {
                    let f = match &lowering.object(lowering.vars[var].now).object.kind {
                        ObjectKind::Texture(_) => "size",
                        ObjectKind::Buffer(b) if b.counted => "capacity",
                        ObjectKind::Buffer(_) => "count",
                    };
                    diagnostic = diagnostic.hint(format!("`{f}({path})` is one"));
                }
                Err(*traced(diagnostic, &lowering.scopes[self.scope].trace))
            }
        }
    }

    fn call_on_name(&self, f: Function, path: &str, span: Span) -> std::result::Result<Lookup, Diagnostic> {
        let mut lowering = self.lowering.borrow_mut();
        let (value, causes) = lowering.measure(self.scope, f, path, span).map_err(|d| *d)?;
        self.causes.borrow_mut().add(&causes);
        Ok(Lookup::Value(value))
    }
}

impl Names<'_, '_> {
    /// `grid.x` where `grid` is no input or part, which could have something called `x`: settled
    /// here, since looking for neighbours of a name that is not there takes long. What is wrong
    /// with it is for the caller to say.
    fn component(&self, path: &str, span: Span) -> Option<std::result::Result<Lookup, Diagnostic>> {
        let (prefix, last) = path.rsplit_once('.')?;
        let index = ["x", "y", "z", "w"].iter().position(|c| *c == last)?;
        if self.lowering.borrow().has_fields(self.scope, prefix) {
            return None;
        }
        Some(match eval::Scope::name(self, prefix, span) {
            Ok(Lookup::Value(Value::Vector(parts))) if index < parts.len() => {
                Ok(Lookup::Value(parts.get(index).unwrap_or(Value::Int(0))))
            }
            Ok(_) => {
                Err(Diagnostic::error(Code::UNKNOWN_NAME, format!("nothing is called `{path}`")).at(span, "unknown"))
            }
            Err(diagnostic) => Err(diagnostic),
        })
    }
}

impl<'p> Lowering<'p> {
    /// Evaluates as far as it is known now.
    pub fn scalar(&mut self, s: ScopeId, expr: &Expr) -> Result<Scalar> {
        let names = Names { lowering: RefCell::new(self), scope: s, causes: RefCell::default() };
        let folded = eval::fold(expr, &names).map_err(Box::new)?;
        let causes = names.causes.into_inner();
        // Arithmetic can fail at other values than these.
        if !matches!(expr.kind, ExprKind::Literal(_) | ExprKind::Name(_)) {
            self.arithmetic.add(&causes);
        }
        let value = match folded.kind {
            ExprKind::Literal(value) => UniformValue::Known(value),
            _ => UniformValue::Live(folded),
        };
        Ok(Scalar { value, causes })
    }

    /// Evaluates what must be known now: sizes, counts, tests.
    pub fn known(&mut self, s: ScopeId, expr: &Expr) -> Result<(Value, CauseSet)> {
        let names = Names { lowering: RefCell::new(self), scope: s, causes: RefCell::default() };
        let value = eval::eval(expr, &names).map_err(Box::new)?;
        let causes = names.causes.into_inner();
        self.structural.add(&causes);
        Ok((value, causes))
    }

    pub fn boolean(&mut self, s: ScopeId, expr: &Expr) -> Result<(bool, CauseSet)> {
        let (value, causes) = self.known(s, expr)?;
        match value {
            Value::Bool(value) => Ok((value, causes)),
            other => Err(self.mistyped(s, expr, "true or false", &other)),
        }
    }

    /// A whole number of at least `least`.
    pub fn whole(&mut self, s: ScopeId, expr: &Expr, what: &str, least: i64) -> Result<(i64, CauseSet)> {
        let (value, causes) = self.known(s, expr)?;
        match value {
            Value::Int(value) if value >= least => Ok((value, causes)),
            Value::Int(value) => {
                let message = format!("{what} must be at least {least}, and is {value}");
                let diagnostic = fault(Code::OUT_OF_RANGE, message, expr.span, format!("this is {value}"));
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
            Value::Float(value) => {
                let message = format!("{what} must be whole, and may be fractional");
                let diagnostic = fault(Code::FRACTIONAL, message, expr.span, format!("this is {value}"))
                    .hint("say `floor(...)`, `ceil(...)` or `ceil_div(a, b)`");
                Err(traced(diagnostic, &self.scopes[s].trace))
            }
            other => Err(self.mistyped(s, expr, "a whole number", &other)),
        }
    }

    pub fn number(&mut self, s: ScopeId, expr: &Expr) -> Result<(f64, CauseSet)> {
        let (value, causes) = self.known(s, expr)?;
        match value.as_f64() {
            Some(number) => Ok((number, causes)),
            None => Err(self.mistyped(s, expr, "a number", &value)),
        }
    }

    pub(super) fn mistyped(&self, s: ScopeId, expr: &Expr, wanted: &str, found: &Value) -> Box<Diagnostic> {
        let message = format!("expected {wanted}, found {found} ({})", found.kind());
        let diagnostic = fault(Code::EXPRESSION_TYPE, message, expr.span, format!("this is {found}"));
        traced(diagnostic, &self.scopes[s].trace)
    }

    pub(super) fn let_value(&mut self, s: ScopeId, i: usize) -> Result<Scalar> {
        let graph = self.scopes[s].graph.clone();
        let derived = &graph.lets[i];
        self.used.insert(derived.name.span);
        match &self.scopes[s].lets[i] {
            LetState::Known { scalar, counts } => {
                self.saw_counter |= counts;
                return Ok(scalar.clone());
            }
            LetState::Evaluating => return Err(self.circle(s, derived.name.span)),
            LetState::Waiting => {}
        }
        self.scopes[s].lets[i] = LetState::Evaluating;
        self.evaluating.push((derived.name.span, derived.name.value.clone()));
        let saw_counter = std::mem::take(&mut self.saw_counter);
        let result = self.scalar(s, &derived.expr);
        let counts = std::mem::replace(&mut self.saw_counter, saw_counter);
        self.saw_counter |= counts;
        self.evaluating.pop();
        self.scopes[s].lets[i] = match &result {
            Ok(scalar) => LetState::Known { scalar: scalar.clone(), counts },
            Err(_) => LetState::Waiting,
        };
        result
    }

    /// A name that is needed to work out its own value: every edge of the circle is shown.
    pub(super) fn circle(&self, s: ScopeId, span: Span) -> Box<Diagnostic> {
        let first = self.evaluating.iter().position(|(open, _)| *open == span).unwrap_or(0);
        let edges = &self.evaluating[first..];
        let name = edges.first().map_or("it", |(_, name)| name.as_str());
        let mut diagnostic = Diagnostic::error(Code::CYCLE, format!("`{name}` needs itself"));
        for (i, (span, _)) in edges.iter().enumerate() {
            let needed = &edges[(i + 1) % edges.len()].1;
            diagnostic = diagnostic.at(*span, format!("needs `{needed}`"));
        }
        traced(diagnostic.hint("one of them must be known without the others"), &self.scopes[s].trace)
    }

    /// A live scalar by its canonical name.
    pub(super) fn live_field(&mut self, root: &str, field: &str, span: Span) -> Scalar {
        self.live(&format!("{root}.{field}"), span)
    }
}
