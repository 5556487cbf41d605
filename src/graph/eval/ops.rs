//! Operators and functions on values. An error is the message's text; who calls knows the place.

use std::cmp::Ordering;

use super::{a_kind, binary_sign, unary_sign};
use crate::graph::expr::{Binary, Function, Unary};
use crate::graph::value::{Value, Vector};

type Made = Result<Value, String>;

const TOO_LARGE: &str = "the result does not fit in a 64-bit whole number";

/// A component of a vector.
pub(super) fn component(value: &Value, name: char) -> Made {
    let index = "xyzw".find(name);
    match value {
        Value::Vector(parts) => match index.and_then(|i| parts.get(i)) {
            Some(part) => Ok(part),
            None => Err(format!("{} has no component `{name}`", a_kind(value))),
        },
        _ => Err(format!("`.{name}` needs a vector, not {}", a_kind(value))),
    }
}

pub(super) fn unary(op: Unary, value: &Value) -> Made {
    match op {
        Unary::Not => match value {
            Value::Bool(b) => Ok(Value::Bool(!b)),
            other => Err(format!("`not` takes a Bool, not {}", a_kind(other))),
        },
        Unary::Negate => each(value, |x| match x {
            Value::Int(i) => i.checked_neg().map(Value::Int).ok_or_else(|| TOO_LARGE.into()),
            Value::Float(x) => Ok(Value::Float(-x)),
            other => Err(format!("`{}` takes numbers, not {}", unary_sign(op), a_kind(other))),
        }),
    }
}

pub(super) fn binary(op: Binary, a: &Value, b: &Value) -> Made {
    match op {
        Binary::And | Binary::Or => match (a, b) {
            (Value::Bool(x), Value::Bool(y)) => Ok(Value::Bool(if op == Binary::And { *x && *y } else { *x || *y })),
            _ => Err(mismatch(op, a, b)),
        },
        Binary::Equal | Binary::NotEqual => {
            let is_equal = equal(a, b).ok_or_else(|| mismatch(op, a, b))?;
            Ok(Value::Bool(is_equal == (op == Binary::Equal)))
        }
        Binary::Less | Binary::LessEqual | Binary::Greater | Binary::GreaterEqual => {
            let order = order(a, b).ok_or_else(|| mismatch(op, a, b))?;
            Ok(Value::Bool(match op {
                Binary::Less => order == Ordering::Less,
                Binary::LessEqual => order != Ordering::Greater,
                Binary::Greater => order == Ordering::Greater,
                _ => order != Ordering::Less,
            }))
        }
        _ => pairs(a, b, |x, y| arithmetic(op, x, y)).map_err(|error| error.unwrap_or_else(|| mismatch(op, a, b))),
    }
}

fn mismatch(op: Binary, a: &Value, b: &Value) -> String {
    format!("`{}` does not take {} and {}", binary_sign(op), a_kind(a), a_kind(b))
}

fn equal(a: &Value, b: &Value) -> Option<bool> {
    match (a, b) {
        (Value::Bool(x), Value::Bool(y)) => Some(x == y),
        (Value::Word(x), Value::Word(y)) => Some(x == y),
        _ => order(a, b).map(|o| o == Ordering::Equal),
    }
}

fn order(a: &Value, b: &Value) -> Option<Ordering> {
    match (a, b) {
        (Value::Int(x), Value::Int(y)) => Some(x.cmp(y)),
        _ => a.as_f64()?.partial_cmp(&b.as_f64()?),
    }
}

/// An operator on two scalars; `Err(None)` if they are not numbers.
fn arithmetic(op: Binary, a: &Value, b: &Value) -> Result<Value, Option<String>> {
    if let (Value::Int(x), Value::Int(y)) = (a, b) {
        let whole = |value: Option<i64>| value.map(Value::Int).ok_or_else(|| Some(TOO_LARGE.into()));
        match op {
            Binary::Add => return whole(x.checked_add(*y)),
            Binary::Subtract => return whole(x.checked_sub(*y)),
            Binary::Multiply => return whole(x.checked_mul(*y)),
            Binary::Remainder if *y == 0 => return Err(Some("the remainder of a division by zero".into())),
            Binary::Remainder => return whole(x.checked_rem(*y)),
            _ => {}
        }
    }
    let (x, y) = (a.as_f64().ok_or(None)?, b.as_f64().ok_or(None)?);
    let value = match op {
        Binary::Add => x + y,
        Binary::Subtract => x - y,
        Binary::Multiply => x * y,
        Binary::Divide if y == 0.0 => return Err(Some("a division by zero".into())),
        Binary::Divide => x / y,
        _ => return Err(Some(format!("`%` takes whole numbers, not {} and {}", a_kind(a), a_kind(b)))),
    };
    finite(value).map_err(Some)
}

fn finite(value: f64) -> Made {
    if value.is_finite() { Ok(Value::Float(value)) } else { Err("the result is not a finite number".into()) }
}

/// Applies to a scalar, or to each component.
fn each(value: &Value, apply: impl Fn(&Value) -> Made) -> Made {
    match value {
        Value::Vector(parts) => vector(parts.iter().map(|part| apply(&part))),
        scalar => apply(scalar),
    }
}

/// Applies to two scalars, component by component, or with a scalar for every component.
fn pairs(
    a: &Value,
    b: &Value,
    apply: impl Fn(&Value, &Value) -> Result<Value, Option<String>>,
) -> Result<Value, Option<String>> {
    match (a, b) {
        (Value::Vector(x), Value::Vector(y)) if x.len() != y.len() => {
            Err(Some(format!("vectors of {} and of {} components do not go together", x.len(), y.len())))
        }
        (Value::Vector(x), Value::Vector(y)) => gather(x.iter().zip(y.iter()).map(|(x, y)| apply(&x, &y)), Some),
        (Value::Vector(x), scalar) => gather(x.iter().map(|x| apply(&x, scalar)), Some),
        (scalar, Value::Vector(y)) => gather(y.iter().map(|y| apply(scalar, &y)), Some),
        _ => apply(a, b),
    }
}

/// A vector of scalars of one kind; Int among Float becomes Float.
pub(super) fn vector(parts: impl IntoIterator<Item = Made>) -> Made {
    gather(parts, |error| error)
}

fn gather<E>(parts: impl IntoIterator<Item = Result<Value, E>>, wrong: impl Fn(String) -> E) -> Result<Value, E> {
    let mut vector = Vector::default();
    for part in parts {
        let part = part?;
        if matches!(part, Value::Vector(_) | Value::Word(_)) {
            return Err(wrong(format!("a component of a vector is a number or a Bool, not {}", a_kind(&part))));
        }
        if vector.push(&part).is_none() {
            return Err(wrong("the components of a vector are all numbers or all Bool".into()));
        }
    }
    Ok(Value::Vector(vector))
}

/// A function of values; the number of arguments was checked when it was read.
pub(super) fn call(function: Function, args: &[Value]) -> Made {
    let name = function.name();
    let [first, rest @ ..] = args else { return Err(format!("`{name}` takes a value")) };
    match function {
        Function::Min | Function::Max => {
            number_check(name, first)?;
            rest.iter().try_fold(first.clone(), |best, next| extreme(function, &best, next))
        }
        Function::Ceil => each(first, |x| rounded(name, x, f64::ceil)),
        Function::Floor => each(first, |x| rounded(name, x, f64::floor)),
        Function::Round => each(first, |x| rounded(name, x, f64::round)),
        Function::Log2 => each(first, |x| match x.as_f64() {
            Some(x) if x > 0.0 => finite(x.log2()),
            Some(_) => Err(format!("`log2` takes numbers above 0, not {x}")),
            None => Err(not_a_number(name, x)),
        }),
        Function::CeilDiv => {
            let second = rest.first().ok_or("`ceil_div` takes two values")?;
            pairs(first, second, ceil_div).map_err(|error| {
                error.unwrap_or_else(|| format!("`ceil_div` does not take {} and {}", a_kind(first), a_kind(second)))
            })
        }
        Function::NextPow2 => each(first, next_pow2),
        Function::MipCount => mip_count(first),
        Function::Size
        | Function::Count
        | Function::Capacity
        | Function::Has
        | Function::Device
        | Function::Mean
        | Function::Sum
        | Function::Nans => Err(format!("`{name}` takes a name, not a value")),
    }
}

fn not_a_number(function: &str, value: &Value) -> String {
    format!("`{function}` takes numbers, not {}", a_kind(value))
}

fn number_check(function: &str, value: &Value) -> Result<(), String> {
    match value.components().find(|part| part.as_f64().is_none()) {
        Some(odd) => Err(not_a_number(function, &odd)),
        None => Ok(()),
    }
}

fn extreme(function: Function, a: &Value, b: &Value) -> Made {
    let wanted = if function == Function::Min { Ordering::Less } else { Ordering::Greater };
    let pick = |x: &Value, y: &Value| match order(x, y) {
        Some(order) => {
            let best = if order == wanted { x } else { y };
            let has_float = matches!(x, Value::Float(_)) || matches!(y, Value::Float(_));
            Ok(match best {
                Value::Int(i) if has_float => Value::Float(*i as f64),
                other => other.clone(),
            })
        }
        None => Err(None),
    };
    pairs(a, b, pick).map_err(|error| {
        error.unwrap_or_else(|| format!("`{}` does not take {} and {}", function.name(), a_kind(a), a_kind(b)))
    })
}

/// A float that is whole as an Int.
fn to_int(x: f64) -> Made {
    // Floats below 2^63 convert exactly once they are whole.
    if x >= -(2f64.powi(63)) && x < 2f64.powi(63) { Ok(Value::Int(x as i64)) } else { Err(TOO_LARGE.into()) }
}

fn rounded(name: &str, value: &Value, round: fn(f64) -> f64) -> Made {
    match value {
        Value::Int(i) => Ok(Value::Int(*i)),
        Value::Float(x) => to_int(round(*x)),
        other => Err(not_a_number(name, other)),
    }
}

fn ceil_div(a: &Value, b: &Value) -> Result<Value, Option<String>> {
    let zero = || Some("`ceil_div` divides by zero".to_string());
    if let (Value::Int(x), Value::Int(y)) = (a, b) {
        if *y == 0 {
            return Err(zero());
        }
        let quotient = x.checked_div(*y).ok_or_else(|| Some(TOO_LARGE.into()))?;
        let rounds_up = x % y != 0 && (*x < 0) == (*y < 0);
        return Ok(Value::Int(quotient + i64::from(rounds_up)));
    }
    let (x, y) = (a.as_f64().ok_or(None)?, b.as_f64().ok_or(None)?);
    if y == 0.0 {
        return Err(zero());
    }
    to_int((x / y).ceil()).map_err(Some)
}

fn next_pow2(value: &Value) -> Made {
    match value {
        Value::Int(i) => match u64::try_from(*i).ok().map(|i| i.max(1).checked_next_power_of_two()) {
            Some(power) => power.and_then(|p| i64::try_from(p).ok()).map(Value::Int).ok_or_else(|| TOO_LARGE.into()),
            None => Err(format!("`next_pow2` takes whole numbers from 0, not {i}")),
        },
        other => Err(format!("`next_pow2` takes whole numbers, not {}", a_kind(other))),
    }
}

/// Levels down to one texel: those of the longest edge.
fn mip_count(value: &Value) -> Made {
    let edges: Option<Vec<i64>> = value.components().map(|part| part.as_int()).collect();
    let longest = edges.ok_or_else(|| format!("`mip_count` takes whole numbers, not {}", a_kind(value)))?;
    match longest.into_iter().max() {
        Some(edge) if edge >= 1 => Ok(Value::Int(i64::from(edge.ilog2()) + 1)),
        _ => Err(format!("`mip_count` takes edges of 1 texel or more, not {value}")),
    }
}
