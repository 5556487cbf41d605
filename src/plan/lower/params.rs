//! Parameters: those that a user can set, and the values that they have.

use super::names::join;
use super::{CauseKind, Lowering, Result, Scalar, ScopeId, fault, traced};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::model::{Param, ParamKind};
use crate::graph::value::Value;
use crate::plan::model::{self, UniformValue};

impl Lowering<'_> {
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
