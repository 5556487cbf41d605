//! The small things that fields hold: expressions, names, paths, views.

use crate::diagnostic::{Code, Diagnostic};
use crate::graph::expr::{self, Expr, ExprKind};
use crate::graph::model::{Bound, Name, View};
use crate::graph::value::Value;
use crate::syntax::{Body, Decoder, Fields, Kind, Node, Sp, Tagged};

/// An entry of a map of named things.
pub(super) struct Named<'n> {
    pub name: Name,
    pub node: &'n Node,
}

/// The entries of a map.
pub(super) fn named<'n>(d: &mut Decoder<'_>, node: &'n Node, what: &str) -> Vec<Named<'n>> {
    let pairs = d.map(node, what).unwrap_or_default();
    pairs.into_iter().filter(|(_, node)| !node.is_invalid()).map(|(name, node)| Named { name, node }).collect()
}

pub(super) fn about(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<String> {
    label(d, fields, "about")
}

/// A text for people.
pub(super) fn label(d: &mut Decoder<'_>, fields: &Fields<'_>, name: &str) -> Option<String> {
    let node = fields.get(name)?;
    d.string(node, &format!("`{name}` of {}", fields.owner)).map(|s| s.value.clone())
}

/// "`field` of `owner`".
pub(super) fn place(fields: &Fields<'_>, field: &str) -> String {
    format!("`{field}` of {}", fields.owner)
}

const EXPRESSION: &str = "a number, `true`, `false`, or an expression in a string";

/// A number, a truth value, a tuple of numbers, or an expression in a string.
pub(super) fn expr(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Expr> {
    let literal = |value| Some(Expr { kind: ExprKind::Literal(value), span: node.span });
    match &node.kind {
        Kind::Int(i) => literal(Value::Int(*i)),
        Kind::Float(x) if x.is_finite() => literal(Value::Float(*x)),
        Kind::Bool(b) => literal(Value::Bool(*b)),
        Kind::Str(text) => match expr::parse(&text.value, text.inner, text.exact) {
            Ok(expr) => Some(expr),
            Err(diagnostic) => {
                d.push(diagnostic);
                None
            }
        },
        Kind::Tagged(Tagged { name: None, body: Body::Items(items), .. }) if (2..=4).contains(&items.len()) => {
            let parts: Vec<Option<Expr>> = items.iter().map(|item| expr(d, item, what)).collect();
            let parts: Option<Vec<Expr>> = parts.into_iter().collect();
            Some(Expr { kind: ExprKind::Vector(parts?), span: node.span })
        }
        Kind::Float(_) => {
            d.wrong(node, what, "a finite number");
            None
        }
        _ => {
            match node.as_word() {
                Some(word) => {
                    let message = format!("{what}: expected {EXPRESSION}, found {}", node.describe());
                    let hint = format!("names stand in strings: \"{}\"", word.value);
                    d.push(Diagnostic::error(Code::WRONG_VALUE, message).at(node.span, "not an expression").hint(hint));
                }
                None => d.wrong(node, what, EXPRESSION),
            }
            None
        }
    }
}

/// The expression of a field, if it is given and can be read.
pub(super) fn expr_field(d: &mut Decoder<'_>, fields: &Fields<'_>, name: &str) -> Option<Expr> {
    let node = fields.get(name)?;
    expr(d, node, &place(fields, name))
}

/// A tuple as one expression for each part, anything else as one expression.
pub(super) fn exprs(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Vec<Expr>> {
    match &node.kind {
        Kind::Tagged(Tagged { name: None, body: Body::Items(items), .. }) if !items.is_empty() => {
            let parts: Vec<Option<Expr>> = items.iter().map(|item| expr(d, item, what)).collect();
            parts.into_iter().collect()
        }
        _ => Some(vec![expr(d, node, what)?]),
    }
}

/// Expressions, as many as `counts` allows; the text says how many that is.
pub(super) fn exprs_of(
    d: &mut Decoder<'_>,
    node: &Node,
    what: &str,
    counts: &[usize],
    expected: &str,
) -> Option<Vec<Expr>> {
    if let Kind::Tagged(Tagged { name: None, body: Body::Items(items), .. }) = &node.kind
        && !counts.contains(&items.len())
    {
        let message = format!("{what}: expected {expected}, found {} values", items.len());
        d.push(Diagnostic::error(Code::WRONG_VALUE, message).at(node.span, format!("expected {expected}")));
        return None;
    }
    exprs(d, node, what)
}

pub(super) fn is_identifier(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The name of a thing: `"z"`, or `"body.z"`.
pub(super) fn path(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Name> {
    let name = d.text(node, what)?;
    check_path(d, &name, what).then_some(name)
}

pub(super) fn check_path(d: &mut Decoder<'_>, name: &Name, what: &str) -> bool {
    let good = name.value.split('.').all(is_identifier);
    if !good {
        let message = format!("{what}: `{}` is not the name of a thing", name.value);
        let diagnostic = Diagnostic::error(Code::BAD_NAME, message)
            .at(name.span, "expected names joined by dots")
            .hint("a name has letters, digits and `_`; a thing of a part is `use.thing`");
        d.push(diagnostic);
    }
    good
}

/// The path of a field, if it is given and can be read.
pub(super) fn path_field(d: &mut Decoder<'_>, fields: &Fields<'_>, name: &str) -> Option<Name> {
    let node = fields.get(name)?;
    path(d, node, &place(fields, name))
}

const VIEW: &str = "the name of a thing in a string, or `View(of:, mip:, layer:)`";

/// `"x"` or `View(of: "x", mip: 0, layer: 1)`.
pub(super) fn view(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<View> {
    match &node.kind {
        Kind::Str(_) => {
            let of = path(d, node, what)?;
            Some(View { span: of.span, of, mip: None, layer: None })
        }
        Kind::Tagged(tagged) if tagged.name.as_ref().is_some_and(|n| n.value == "View") => {
            let fields = d.body_fields(tagged, "`View`", &["of", "mip", "layer"])?;
            view_fields(d, &fields, "of", node)
        }
        _ => {
            d.wrong(node, what, VIEW);
            None
        }
    }
}

/// A view out of the fields `of` (by the name given), `mip` and `layer`.
pub(super) fn view_fields(d: &mut Decoder<'_>, fields: &Fields<'_>, of: &str, node: &Node) -> Option<View> {
    let mip = expr_field(d, fields, "mip");
    let layer = expr_field(d, fields, "layer");
    let thing = fields.require(d, of)?;
    let given = view(d, thing, &place(fields, of))?;
    let is_part = given.mip.is_some() || given.layer.is_some();
    if is_part && let Some((name, _)) = fields.entry("mip").or_else(|| fields.entry("layer")) {
        let message = format!("`{}` of {} is given beside a `View`", name.value, fields.owner);
        d.push(
            Diagnostic::error(Code::WRONG_VALUE, message)
                .at(name.span, "given here")
                .see(given.span, "this names a part already"),
        );
        return None;
    }
    Some(View { of: given.of, mip: mip.or(given.mip), layer: layer.or(given.layer), span: node.span })
}

/// `bind: {"wgsl_name": "thing or expression"}`.
pub(super) fn bind(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Vec<(Name, Bound)> {
    let Some(node) = fields.get("bind") else { return Vec::new() };
    let mut out = Vec::new();
    for entry in named(d, node, &place(fields, "bind")) {
        if !is_identifier(&entry.name.value) {
            let message = format!("{}: `{}` is no name that WGSL could have", place(fields, "bind"), entry.name.value);
            d.push(
                Diagnostic::error(Code::BAD_NAME, message)
                    .at(entry.name.span, "not an identifier")
                    .hint("the key is the shader's name, the value is the graph's; a dot is written `_` in WGSL"),
            );
            continue;
        }
        let what = format!("`{}` in {}", entry.name.value, place(fields, "bind"));
        let bound = match entry.node.as_tagged() {
            Some(Tagged { name: Some(_), .. }) => view(d, entry.node, &what).map(Bound::View),
            _ => expr(d, entry.node, &what).map(Bound::Expr),
        };
        out.extend(bound.map(|bound| (entry.name, bound)));
    }
    out
}

/// A tagged value `Word(...)`, or what is expected.
pub(super) fn tagged<'n>(
    d: &mut Decoder<'_>,
    node: &'n Node,
    what: &str,
    expected: &str,
) -> Option<(&'n Sp<String>, &'n Tagged)> {
    let found = node.as_tagged().and_then(|t| t.name.as_ref().map(|name| (name, t)));
    if found.is_none() {
        d.wrong(node, what, expected);
    }
    found
}
