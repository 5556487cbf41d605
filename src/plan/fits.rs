//! How much of what was asked for a device has room for: the hint beside what does not fit.

use super::model::{Plan, Request};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::graph::value::Value;
use crate::program::Program;

/// Says beside what the device is too small for which given parameter, made smaller, would do.
pub(super) fn explain(
    mut found: Diagnostics,
    request: &Request,
    program: &Program,
    plan: impl Fn(&Program, &Request) -> Result<Plan, Diagnostics>,
) -> Diagnostics {
    if !is_too_large(&found) {
        return found;
    }
    let fitting = request.params.iter().filter_map(|(path, value)| {
        let Value::Int(given) = value else { return None };
        let largest = largest(*given, |smaller| {
            let mut other = request.clone();
            other.params.insert(path.clone(), Value::Int(smaller));
            plan(program, &other)
        })?;
        Some(format!("with all else as it is, the largest `{path}` that fits is {largest}"))
    });
    let hints: Vec<String> = fitting.collect();
    if let Some(first) = found.0.iter_mut().find(|d| d.id == Code::DEVICE_LIMIT) {
        *first = hints.into_iter().fold(first.clone(), Diagnostic::hint);
    }
    found
}

fn is_too_large(found: &Diagnostics) -> bool {
    found.iter().any(|d| d.id == Code::DEVICE_LIMIT)
}

/// The largest number below `given` that plans, by bisection; none if no smaller one does.
fn largest(given: i64, plan: impl Fn(i64) -> Result<Plan, Diagnostics>) -> Option<i64> {
    // Too small for the parameter is not too large for the device.
    let fits = |number| plan(number).err().is_none_or(|found| !is_too_large(&found));
    let (mut low, mut high) = (0, given);
    if given <= 0 || !fits(low) {
        return None;
    }
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if fits(middle) { low = middle } else { high = middle }
    }
    plan(low).is_ok().then_some(low)
}
