//! `params:`, and whether a declaration makes sense in itself.

use super::values::{self, Named, place, tagged};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::model::{Name, Param, ParamKind};
use crate::graph::value::Value;
use crate::syntax::{Decoder, Fields, Node, Sp};

const KINDS: &[&str] = &["Int", "Float", "Bool", "Choice", "Vec2", "Vec3", "Vec4", "Color"];

/// What both `i32` and `u32` variables can be fed from lies between these.
const INT_RANGE: (i64, i64) = (i32::MIN as i64, u32::MAX as i64);

pub(super) fn param(d: &mut Decoder<'_>, entry: &Named<'_>) -> Option<Param> {
    let what = format!("the parameter `{}`", entry.name.value);
    let (word, tag) = tagged(d, entry.node, &what, "a kind of parameter such as `Int(...)` or `Float(...)`")?;
    let known: &[&str] = match word.value.as_str() {
        "Bool" => &["default", "about"],
        "Choice" => &["of", "default", "about"],
        kind if KINDS.contains(&kind) => &["default", "min", "max", "unit", "about"],
        _ => {
            d.unknown_word(word, &what, KINDS);
            return None;
        }
    };
    let fields = d.body_fields(tag, &what, known)?;
    let kind = match word.value.as_str() {
        "Int" => ParamKind::Int,
        "Float" => ParamKind::Float,
        "Bool" => ParamKind::Bool,
        "Vec2" => ParamKind::Vec2,
        "Vec3" => ParamKind::Vec3,
        "Vec4" => ParamKind::Vec4,
        "Color" => ParamKind::Color,
        _ => ParamKind::Choice(words(d, &fields)?),
    };
    let bound = |d: &mut Decoder<'_>, name: &str| {
        let node = fields.get(name)?;
        let value = match kind {
            ParamKind::Int => int(d, node, &place(&fields, name))?,
            _ => Value::Float(d.float(node, &place(&fields, name))?),
        };
        Some(Sp { value, span: node.span })
    };
    let (min, max) = (bound(d, "min"), bound(d, "max"));
    let default = fields.get("default").and_then(|node| default(d, node, &kind, &place(&fields, "default")));
    let param = Param {
        name: entry.name.clone(),
        kind,
        default,
        min,
        max,
        unit: values::label(d, &fields, "unit"),
        about: values::about(d, &fields),
        span: entry.name.span.to(entry.node.span),
    };
    check_range(d, &param);
    Some(param)
}

/// The words of a `Choice`.
fn words(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<Vec<Name>> {
    let node = fields.require(d, "of")?;
    let what = place(fields, "of");
    let mut out: Vec<Name> = Vec::new();
    for item in d.list(node, &what)? {
        let Some(word) = d.text(item, &what) else { continue };
        match out.iter().find(|w| w.value == word.value) {
            Some(first) => d.push(super::names::duplicate("the word", &word, first.span)),
            None if word.value.is_empty() || word.value.contains('\'') => {
                let message = format!("{what}: `{}` cannot be a word of a choice", word.value);
                let diagnostic = Diagnostic::error(Code::BAD_PARAMETER, message)
                    .at(item.span, "this word")
                    .hint("a word is not empty and has no single quote, since expressions write it in single quotes");
                d.push(diagnostic);
            }
            None => out.push(word),
        }
    }
    if out.is_empty() && !node.is_invalid() {
        d.push(
            Diagnostic::error(Code::BAD_PARAMETER, format!("{what} names no words"))
                .at(node.span, "at least one is needed"),
        );
        return None;
    }
    Some(out)
}

fn int(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Value> {
    d.int_within(node, what, INT_RANGE.0, INT_RANGE.1).map(Value::Int)
}

fn default(d: &mut Decoder<'_>, node: &Node, kind: &ParamKind, what: &str) -> Option<Sp<Value>> {
    let value = match kind {
        ParamKind::Int => int(d, node, what)?,
        ParamKind::Float => Value::Float(d.float(node, what)?),
        ParamKind::Bool => Value::Bool(d.bool(node, what)?),
        ParamKind::Vec2 => Value::vec(d.floats::<2>(node, what)?),
        ParamKind::Vec3 => Value::vec(d.floats::<3>(node, what)?),
        ParamKind::Vec4 => Value::vec(d.floats::<4>(node, what)?),
        ParamKind::Color => {
            let items = d.items(node, what, "a tuple of 3 or 4 numbers", 3..=4)?;
            let parts: Vec<Option<f64>> = items.iter().map(|item| d.float(item, what)).collect();
            Value::vec(parts.into_iter().collect::<Option<Vec<f64>>>()?)
        }
        ParamKind::Choice(words) => {
            let word = d.text(node, what)?;
            let known: Vec<&str> = words.iter().map(|w| w.value.as_str()).collect();
            if !known.contains(&word.value.as_str()) {
                let message = format!("{what}: `{}` is not one of its words", word.value);
                let diagnostic = Diagnostic::error(Code::BAD_PARAMETER, message)
                    .at(word.span, "not one of the words")
                    .nearest(&word.value, known.iter().copied())
                    .hint(format!("the words are {}", known.join(", ")));
                d.push(diagnostic);
                return None;
            }
            Value::Word(word.value)
        }
    };
    Some(Sp { value, span: node.span })
}

/// Bounds in order, default between them.
fn check_range(d: &mut Decoder<'_>, param: &Param) {
    let name = &param.name.value;
    if let (Some(min), Some(max)) = (&param.min, &param.max)
        && min.value.as_f64() > max.value.as_f64()
    {
        let message = format!("the parameter `{name}` has a `min` of {} above its `max` of {}", min.value, max.value);
        d.push(Diagnostic::error(Code::BAD_PARAMETER, message).at(min.span, "the least").see(max.span, "the greatest"));
        return;
    }
    let Some(default) = &param.default else { return };
    let components = || default.value.numbers();
    let low = param.min.as_ref().filter(|min| min.value.as_f64().is_some_and(|m| components().any(|x| x < m)));
    let high = param.max.as_ref().filter(|max| max.value.as_f64().is_some_and(|m| components().any(|x| x > m)));
    for (bound, word) in [(low, "min"), (high, "max")] {
        if let Some(bound) = bound {
            let side = if word == "min" { "below" } else { "above" };
            let message = format!(
                "the default {} of the parameter `{name}` is {side} its `{word}` of {}",
                default.value, bound.value
            );
            d.push(
                Diagnostic::error(Code::BAD_PARAMETER, message)
                    .at(default.span, format!("{side} `{word}`"))
                    .see(bound.span, "the bound"),
            );
        }
    }
}
