//! Scalars: parameters, `let` names, expressions, and what each depends on.

use std::cell::RefCell;

use super::names::{Entity, join};
use super::{CauseKind, CauseSet, LetState, Lowering, Result, Scalar, ScopeId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::eval::{self, Lookup};
use crate::graph::expr::{Expr, ExprKind, Function};
use crate::graph::model::{Param, ParamKind};
use crate::graph::value::Value;
use crate::plan::model::{self, ObjectKind, UniformValue};

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

    /// Parameters under their instance paths: those that nobody gave are shown to users.
    pub(super) fn declare_params(&mut self, s: ScopeId) {
        let graph = self.scopes[s].graph.clone();
        for i in 0..graph.params.len() {
            if self.scopes[s].given.contains_key(&graph.params[i].name.value) {
                continue;
            }
            let value = self.own_param(s, i);
            let Some(Scalar { value: UniformValue::Known(value), .. }) = self.report(value) else { continue };
            let param = &graph.params[i];
            let path = join(&self.scopes[s].path, &param.name.value);
            let shown = model::Param {
                path: path.clone(),
                kind: param.kind.clone(),
                value,
                default: param.default.as_ref().map(|d| d.value.clone()),
                min: param.min.as_ref().map(|d| d.value.clone()),
                max: param.max.as_ref().map(|d| d.value.clone()),
                unit: param.unit.clone(),
                about: param.about.clone(),
                span: param.name.span,
            };
            self.params.insert(path, shown);
        }
    }

    pub(super) fn param(&mut self, s: ScopeId, i: usize) -> Result<Scalar> {
        let graph = self.scopes[s].graph.clone();
        let param = &graph.params[i];
        self.used.insert(param.name.span);
        match self.scopes[s].given.get(&param.name.value) {
            Some((scalar, _)) => {
                self.saw_counter |= self.scopes[s].given_counts;
                Ok(scalar.clone())
            }
            None => self.own_param(s, i),
        }
    }

    /// The value of a parameter that no `Use` gives.
    fn own_param(&mut self, s: ScopeId, i: usize) -> Result<Scalar> {
        if let Some(known) = &self.scopes[s].own_params[i] {
            return Ok(known.clone());
        }
        let graph = self.scopes[s].graph.clone();
        let param = &graph.params[i];
        let path = join(&self.scopes[s].path, &param.name.value);
        let causes = self.causes.set(CauseKind::Param, &path);
        let given = match (self.request.params.get(&path), &param.default) {
            (Some(value), _) => value.clone(),
            (None, Some(default)) => default.value.clone(),
            (None, None) if self.stand_in => made_up(param),
            (None, None) => {
                let message = format!("the parameter `{}` has no default and nobody gives it", param.name.value);
                let diagnostic = fault(Code::MISSING_FIELD, message, param.name.span, "the parameter");
                return Err(traced(diagnostic, &self.scopes[s].trace));
            }
        };
        let value = self.fit(Scalar::caused(given, causes), param, param.name.span)?;
        self.scopes[s].own_params[i] = Some(value.clone());
        Ok(value)
    }

    /// Makes a given value the parameter's own kind, or says why it does not fit.
    pub(super) fn fit(&self, scalar: Scalar, param: &Param, at: Span) -> Result<Scalar> {
        let UniformValue::Known(value) = &scalar.value else { return Ok(scalar) };
        let name = &param.name.value;
        let Some(fitted) = convert(value, &param.kind) else {
            let message = format!("`{name}` is {} and cannot be {value} ({})", kind(&param.kind), value.kind());
            let diagnostic = Diagnostic::error(Code::BAD_PARAMETER, message).at(at, "given here");
            return Err(Box::new(with_declaration(diagnostic, param, at)));
        };
        for (bound, low) in [(&param.min, true), (&param.max, false)] {
            let Some(limit) = bound.as_ref().and_then(|b| b.value.as_f64()) else { continue };
            let outside = fitted.numbers().any(|x| if low { x < limit } else { x > limit });
            if outside {
                let side = if low { "at least" } else { "at most" };
                let message = format!("`{name}` must be {side} {limit}, and is {fitted}");
                let diagnostic = Diagnostic::error(Code::BAD_PARAMETER, message).at(at, "given here");
                return Err(Box::new(with_declaration(diagnostic, param, at)));
            }
        }
        Ok(Scalar { value: UniformValue::Known(fitted), causes: scalar.causes })
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

    /// `size(x)`, `count(x)`, `capacity(x)`, `has(x)`, `device(x)`.
    fn measure(&mut self, s: ScopeId, f: Function, path: &str, span: Span) -> Result<(Value, CauseSet)> {
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

    /// A live scalar by its canonical name.
    pub(super) fn live_field(&mut self, root: &str, field: &str, span: Span) -> Scalar {
        self.live(&format!("{root}.{field}"), span)
    }
}

fn with_declaration(diagnostic: Diagnostic, param: &Param, at: Span) -> Diagnostic {
    let diagnostic = if at == param.name.span { diagnostic } else { diagnostic.see(param.name.span, "declared here") };
    match &param.kind {
        ParamKind::Choice(words) => {
            let words: Vec<String> = words.iter().map(|w| w.value.clone()).collect();
            diagnostic.hint(format!("it is one of {}", super::names::list(&words)))
        }
        _ => diagnostic,
    }
}

/// What messages call a parameter's kind, with its article.
fn kind(kind: &ParamKind) -> String {
    match kind {
        ParamKind::Int => "an Int".to_owned(),
        other => format!("a {}", other.name()),
    }
}

/// The value as the kind has it; `None` if it does not fit.
pub(in crate::plan) fn convert(value: &Value, kind: &ParamKind) -> Option<Value> {
    let vector = |n: &[usize]| match value {
        Value::Vector(v) if n.contains(&v.len()) => {
            (value.numbers().count() == v.len()).then(|| Value::vec(value.numbers()))
        }
        _ => None,
    };
    match (kind, value) {
        (ParamKind::Int, Value::Int(_)) | (ParamKind::Bool, Value::Bool(_)) => Some(value.clone()),
        (ParamKind::Float, Value::Int(_) | Value::Float(_)) => value.as_f64().map(Value::Float),
        (ParamKind::Choice(words), Value::Word(word)) => words.iter().any(|w| w.value == *word).then(|| value.clone()),
        (ParamKind::Vec2, _) => vector(&[2]),
        (ParamKind::Vec3, _) => vector(&[3]),
        (ParamKind::Vec4, _) => vector(&[4]),
        (ParamKind::Color, _) => vector(&[3, 4]),
        _ => None,
    }
}

/// A value for a part's parameter when the part is checked by itself.
fn made_up(param: &Param) -> Value {
    let low = param.min.as_ref().and_then(|v| v.value.as_f64()).unwrap_or(0.0);
    let high = param.max.as_ref().and_then(|v| v.value.as_f64()).unwrap_or(f64::MAX);
    let number = |want: f64| want.clamp(low, high);
    match &param.kind {
        ParamKind::Int => Value::Int(number(64.0) as i64),
        ParamKind::Float => Value::Float(number(1.0)),
        ParamKind::Bool => Value::Bool(false),
        ParamKind::Choice(words) => Value::Word(words.first().map(|w| w.value.clone()).unwrap_or_default()),
        ParamKind::Vec2 => Value::vec([number(1.0); 2]),
        ParamKind::Vec3 | ParamKind::Color => Value::vec([number(1.0); 3]),
        ParamKind::Vec4 => Value::vec([number(1.0); 4]),
    }
}
