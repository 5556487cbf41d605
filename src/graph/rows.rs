//! Rows of named values and single values, as scenes and defaults write them.

use std::collections::BTreeMap;

use super::value::Value;
use crate::syntax::{Body, Decoder, Kind, Node, Sp, Tagged};

/// A row of a table: values by name.
pub type Row = BTreeMap<String, Value>;

/// `[(position: (0, 1, 0), radius: 0.5), ...]`.
pub(crate) fn rows(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Vec<Row>> {
    let rows = d.list(node, what)?;
    let read: Vec<_> = rows.iter().map(|node| row(d, node, what)).collect();
    read.into_iter().collect()
}

fn row(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Row> {
    let entries: Vec<(Sp<String>, &Node)> = match &node.kind {
        Kind::Map(_) => d.map(node, what)?,
        Kind::Tagged(Tagged { name: None, body: Body::Fields(fields), .. }) => {
            fields.iter().map(|(name, value)| (name.clone(), value)).collect()
        }
        _ => {
            d.wrong(node, what, "a row of named values in brackets");
            return None;
        }
    };
    let mut row = Row::new();
    let mut good = true;
    for (name, node) in entries {
        match value(d, node, &format!("`{}` of {what}", name.value)) {
            Some(value) => _ = row.insert(name.value, value),
            None => good = false,
        }
    }
    good.then_some(row)
}

/// A number, a truth value, a word (also in quotes) or a tuple of 2 to 4 numbers.
pub(crate) fn value(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Value> {
    match &node.kind {
        Kind::Bool(b) => Some(Value::Bool(*b)),
        Kind::Int(i) => Some(Value::Int(*i)),
        Kind::Float(_) => d.float(node, what).map(Value::Float),
        Kind::Str(s) => Some(Value::Word(s.value.clone())),
        Kind::Tagged(Tagged { name: Some(word), body: Body::Unit, .. }) => Some(Value::Word(word.value.clone())),
        Kind::Tagged(Tagged { name: None, body: Body::Items(_), .. }) => {
            let items = d.items(node, what, "a tuple of 2 to 4 numbers", 2..=4)?;
            let numbers: Vec<_> = items.iter().map(|item| d.float(item, what)).collect();
            numbers.into_iter().collect::<Option<Vec<f64>>>().map(Value::vec)
        }
        _ => {
            d.wrong(node, what, "a number, a truth value, a word or a tuple of numbers");
            None
        }
    }
}
