//! Expressions into values: fully when a graph is planned, partly for what is known only while
//! frames run.
//!
//! What a name stands for is the business of a [`Scope`]. Kinds: Int and Float promote, Int by
//! Int is Float, vectors go component by component and with scalars. Whole numbers that overflow,
//! division by zero and results that are not finite are errors.

mod ops;

use super::expr::{Binary, Expr, ExprKind, Function, Unary};
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic, Span};

/// What a name stands for.
#[derive(Clone, Debug, PartialEq)]
pub enum Lookup {
    Value(Value),
    /// Known only while a frame runs: a canonical name, or an expression of such names.
    Live(Expr),
}

/// What the names of an expression stand for.
pub trait Scope {
    /// The value of a dotted path as written. A component such as `grid.x` is asked for as a
    /// whole first, then as `grid`.
    ///
    /// # Errors
    /// A diagnostic that points at `span` if nothing has that name.
    fn name(&self, path: &str, span: Span) -> Result<Lookup, Diagnostic>;

    /// The value of `size(x)`, `count(x)`, `capacity(x)`, `has(x)` or `device(x)`.
    ///
    /// # Errors
    /// A diagnostic that points at `span` if `path` is no such thing.
    fn call_on_name(&self, function: Function, path: &str, span: Span) -> Result<Lookup, Diagnostic>;

    /// The words that a `Choice` of that name may have, to catch comparisons that cannot hold.
    fn words(&self, path: &str) -> Option<Vec<String>> {
        _ = path;
        None
    }
}

/// The value of an expression.
///
/// # Errors
/// `expression-type` and whatever the scope says; `not-known-when-planning` if the value depends
/// on something that is known only while a frame runs.
pub fn eval(expr: &Expr, scope: &dyn Scope) -> Result<Value, Diagnostic> {
    let folded = fold(expr, scope)?;
    match folded.kind {
        ExprKind::Literal(value) => Ok(value),
        _ => {
            let mut live = None;
            folded.names(&mut |name, span| live = live.or(Some((name, span))));
            let (name, span) = live.unwrap_or(("this", expr.span));
            Err(Diagnostic::error(
                Code::NOT_KNOWN_WHEN_PLANNING,
                format!("`{name}` is known only while a frame runs, but decides the plan here"),
            )
            .at(span, "changes from frame to frame")
            .hint("sizes, counts, loops and tests may use parameters, `let` names, sizes and counts"))
        }
    }
}

/// As much of an expression as is known now: literals where nothing live is involved, else a tree
/// whose names are the canonical names of live scalars. `and` and `or` leave their right side
/// alone if the left one decides.
///
/// # Errors
/// As [`eval`], but for live names, which stay.
pub fn fold(expr: &Expr, scope: &dyn Scope) -> Result<Expr, Diagnostic> {
    let kind = match &expr.kind {
        ExprKind::Literal(value) => ExprKind::Literal(value.clone()),
        ExprKind::Name(path) => name(path, expr.span, scope)?,
        ExprKind::Component(inner, c) => {
            let inner = fold(inner, scope)?;
            match literal(&inner) {
                Some(value) => {
                    ExprKind::Literal(ops::component(value, *c).map_err(|m| wrong(m, expr.span, &[&inner]))?)
                }
                None => ExprKind::Component(Box::new(inner), *c),
            }
        }
        ExprKind::Unary(op, inner) => {
            let inner = fold(inner, scope)?;
            match literal(&inner) {
                Some(value) => ExprKind::Literal(ops::unary(*op, value).map_err(|m| wrong(m, expr.span, &[&inner]))?),
                None => ExprKind::Unary(*op, Box::new(inner)),
            }
        }
        ExprKind::Binary(op, a, b) => return binary(*op, a, b, expr.span, scope),
        ExprKind::Call(function, args) if function.takes_name() => {
            match args.first().map(|arg| (&arg.kind, arg.span)) {
                Some((ExprKind::Name(path), span)) => from_lookup(scope.call_on_name(*function, path, span)?),
                _ => return Err(wrong(format!("`{}` takes a name", function.name()), expr.span, &[])),
            }
        }
        ExprKind::Call(function, args) => {
            let args = fold_all(args, scope)?;
            match literals(&args) {
                Some(values) => {
                    let value = ops::call(*function, &values).map_err(|m| wrong(m, expr.span, &refs(&args)))?;
                    ExprKind::Literal(value)
                }
                None => ExprKind::Call(*function, args),
            }
        }
        // Statistics replace these before.
        ExprKind::Item(..) => return Err(wrong("items of buffers cannot be read here".into(), expr.span, &[])),
        ExprKind::Vector(parts) => {
            let parts = fold_all(parts, scope)?;
            match literals(&parts) {
                Some(values) => ExprKind::Literal(
                    ops::vector(values.into_iter().map(Ok)).map_err(|m| wrong(m, expr.span, &refs(&parts)))?,
                ),
                None => ExprKind::Vector(parts),
            }
        }
    };
    Ok(Expr { kind, span: expr.span })
}

/// The value of a folded expression while a frame runs; absent if a name has no value or the
/// operands do not fit.
pub fn eval_live(expr: &Expr, live: &dyn Fn(&str) -> Option<Value>) -> Option<Value> {
    match &expr.kind {
        ExprKind::Literal(value) => Some(value.clone()),
        ExprKind::Name(path) => live(path).or_else(|| {
            let (prefix, c) = component_of(path)?;
            ops::component(&live(prefix)?, c).ok()
        }),
        ExprKind::Component(inner, c) => ops::component(&eval_live(inner, live)?, *c).ok(),
        ExprKind::Unary(op, inner) => ops::unary(*op, &eval_live(inner, live)?).ok(),
        ExprKind::Binary(op, a, b) => {
            let left = eval_live(a, live)?;
            match decided(*op, &left) {
                Some(value) => Some(value),
                None => ops::binary(*op, &left, &eval_live(b, live)?).ok(),
            }
        }
        ExprKind::Call(function, _) if function.takes_name() => None,
        ExprKind::Item(..) => None,
        ExprKind::Call(function, args) => {
            // Most have one or two: nothing is allocated for those while frames run.
            match args.as_slice() {
                [a] => ops::call(*function, &[eval_live(a, live)?]),
                [a, b] => ops::call(*function, &[eval_live(a, live)?, eval_live(b, live)?]),
                args => ops::call(*function, &args.iter().map(|arg| eval_live(arg, live)).collect::<Option<Vec<_>>>()?),
            }
            .ok()
        }
        ExprKind::Vector(parts) => {
            ops::vector(parts.iter().map(|part| eval_live(part, live).ok_or_else(String::new))).ok()
        }
    }
}

/// A value that must be a whole number.
///
/// # Errors
/// `fractional` if it is a Float, `expression-type` if it is no number; `what` names the place.
pub fn whole(value: &Value, span: Span, what: &str) -> Result<i64, Diagnostic> {
    match value {
        Value::Int(i) => Ok(*i),
        Value::Float(_) => Err(Diagnostic::error(
            Code::FRACTIONAL,
            format!("{what} must be a whole number, and this is the Float {value}"),
        )
        .at(span, "may be fractional")
        .hint("say which way to round: `floor(...)`, `ceil(...)`, `round(...)` or `ceil_div(a, b)`; Int divided by Int is Float")),
        other => Err(expected(what, "a whole number", other, span)),
    }
}

/// A value that must be a truth value.
///
/// # Errors
/// `expression-type` if it is something else; `what` names the place.
pub fn truth(value: &Value, span: Span, what: &str) -> Result<bool, Diagnostic> {
    value.as_bool().ok_or_else(|| expected(what, "a Bool", value, span))
}

/// A value that must be a number.
///
/// # Errors
/// `expression-type` if it is something else; `what` names the place.
pub fn number(value: &Value, span: Span, what: &str) -> Result<f64, Diagnostic> {
    value.as_f64().ok_or_else(|| expected(what, "a number", value, span))
}

fn expected(what: &str, expected: &str, found: &Value, span: Span) -> Diagnostic {
    Diagnostic::error(Code::EXPRESSION_TYPE, format!("{what} must be {expected}, found {}", a_kind(found)))
        .at(span, format!("this is {}", a_kind(found)))
}

/// The kind of a value with its article.
fn a_kind(value: &Value) -> String {
    let kind = value.kind();
    let article = if kind.starts_with(['A', 'E', 'I', 'O', 'U', 'a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {kind}")
}

fn literal(expr: &Expr) -> Option<&Value> {
    match &expr.kind {
        ExprKind::Literal(value) => Some(value),
        _ => None,
    }
}

fn literals(exprs: &[Expr]) -> Option<Vec<Value>> {
    exprs.iter().map(|expr| literal(expr).cloned()).collect()
}

fn refs(exprs: &[Expr]) -> Vec<&Expr> {
    exprs.iter().collect()
}

fn fold_all(exprs: &[Expr], scope: &dyn Scope) -> Result<Vec<Expr>, Diagnostic> {
    exprs.iter().map(|expr| fold(expr, scope)).collect()
}

fn from_lookup(lookup: Lookup) -> ExprKind {
    match lookup {
        Lookup::Value(value) => ExprKind::Literal(value),
        Lookup::Live(live) => live.kind,
    }
}

/// `grid.x` as `grid` and `x`.
fn component_of(path: &str) -> Option<(&str, char)> {
    let (prefix, last) = path.rsplit_once('.')?;
    let mut chars = last.chars();
    let c = chars.next().filter(|c| "xyzw".contains(*c))?;
    chars.next().is_none().then_some((prefix, c))
}

/// The whole path, or else a component of what its front part names.
fn name(path: &str, span: Span, scope: &dyn Scope) -> Result<ExprKind, Diagnostic> {
    let error = match scope.name(path, span) {
        Ok(lookup) => return Ok(from_lookup(lookup)),
        Err(error) => error,
    };
    let Some((prefix, c)) = component_of(path) else { return Err(error) };
    match scope.name(prefix, span) {
        Ok(Lookup::Value(value)) => ops::component(&value, c).map(ExprKind::Literal).map_err(|message| {
            Diagnostic::error(Code::EXPRESSION_TYPE, message).at(span, format!("`{prefix}` is {}", told(&value)))
        }),
        Ok(Lookup::Live(live)) => Ok(ExprKind::Component(Box::new(live), c)),
        Err(_) => Err(error),
    }
}

/// The result, if the left side alone decides it.
fn decided(op: Binary, left: &Value) -> Option<Value> {
    match (op, left) {
        (Binary::And, Value::Bool(false)) => Some(Value::Bool(false)),
        (Binary::Or, Value::Bool(true)) => Some(Value::Bool(true)),
        _ => None,
    }
}

fn binary(op: Binary, a: &Expr, b: &Expr, span: Span, scope: &dyn Scope) -> Result<Expr, Diagnostic> {
    check_word(op, a, b, scope)?;
    check_word(op, b, a, scope)?;
    let left = fold(a, scope)?;
    if let Some(value) = literal(&left).and_then(|value| decided(op, value)) {
        return Ok(Expr { kind: ExprKind::Literal(value), span });
    }
    let right = fold(b, scope)?;
    let kind = match (literal(&left), literal(&right)) {
        (Some(x), Some(y)) => {
            ExprKind::Literal(ops::binary(op, x, y).map_err(|message| wrong(message, span, &[&left, &right]))?)
        }
        _ => ExprKind::Binary(op, Box::new(left), Box::new(right)),
    };
    Ok(Expr { kind, span })
}

/// A comparison of a `Choice` with a word that it cannot be is a slip.
fn check_word(op: Binary, choice: &Expr, word: &Expr, scope: &dyn Scope) -> Result<(), Diagnostic> {
    let (Binary::Equal | Binary::NotEqual, ExprKind::Name(path), ExprKind::Literal(Value::Word(text))) =
        (op, &choice.kind, &word.kind)
    else {
        return Ok(());
    };
    match scope.words(path) {
        Some(words) if !words.contains(text) => {
            Err(Diagnostic::error(Code::UNKNOWN_VARIANT, format!("`{path}` is never `'{text}'`"))
                .at(word.span, "not one of its words")
                .nearest(text, words.iter().map(String::as_str))
                .hint(format!("the words of `{path}` are {}", words.join(", "))))
        }
        _ => Ok(()),
    }
}

/// A type error over an expression, with the kinds of its operands.
fn wrong(message: String, span: Span, operands: &[&Expr]) -> Diagnostic {
    let mut diagnostic = Diagnostic::error(Code::EXPRESSION_TYPE, message);
    diagnostic = match operands {
        // One operand fills most of the expression: say it once.
        [] | [_] => diagnostic.at(span, operands.first().and_then(|o| literal(o)).map(told).unwrap_or_default()),
        _ => diagnostic.at(span, ""),
    };
    if operands.len() > 1 {
        for operand in operands.iter().filter(|o| o.span != span) {
            if let Some(value) = literal(operand) {
                diagnostic = diagnostic.see(operand.span, told(value));
            }
        }
    }
    diagnostic
}

/// A value with its kind, for labels.
fn told(value: &Value) -> String {
    match value {
        Value::Word(word) => format!("the word '{word}'"),
        _ => format!("{}: {value}", a_kind(value)),
    }
}

/// The sign of an operator, for messages.
pub(crate) fn unary_sign(op: Unary) -> &'static str {
    match op {
        Unary::Negate => "-",
        Unary::Not => "not",
    }
}

/// The sign of an operator, for messages.
pub(crate) fn binary_sign(op: Binary) -> &'static str {
    match op {
        Binary::Add => "+",
        Binary::Subtract => "-",
        Binary::Multiply => "*",
        Binary::Divide => "/",
        Binary::Remainder => "%",
        Binary::Equal => "==",
        Binary::NotEqual => "!=",
        Binary::Less => "<",
        Binary::LessEqual => "<=",
        Binary::Greater => ">",
        Binary::GreaterEqual => ">=",
        Binary::And => "and",
        Binary::Or => "or",
    }
}
