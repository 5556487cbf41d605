//! `inputs:`.

use super::defaults;
use super::params;
use super::values::{Named, is_identifier, named, tagged};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::model::{Attribute, Input, InputKind, MESH_FIELDS, Param, ParamKind, ViewDimension};
use crate::syntax::{Decoder, Fields, Node};

const KINDS: &[&str] = &["Camera", "Light", "Pointer", "Particles", "Meshes", "Table", "Texture", "Buffer", "Counted"];

const DIMENSIONS: &[(&str, ViewDimension)] = &[
    ("D2", ViewDimension::D2),
    ("D2Array", ViewDimension::D2Array),
    ("Cube", ViewDimension::Cube),
    ("CubeArray", ViewDimension::CubeArray),
    ("D3", ViewDimension::D3),
];

pub(super) fn input(d: &mut Decoder<'_>, entry: &Named<'_>) -> Option<Input> {
    let what = format!("the input `{}`", entry.name.value);
    let (word, tag) = tagged(d, entry.node, &what, "a kind of input such as `Camera` or `Texture`")?;
    let owner = format!("`{}`", word.value);
    let known: &[&str] = match word.value.as_str() {
        "Particles" => &["attributes", "optional", "default"],
        "Texture" => &["dimension", "optional", "default"],
        "Light" | "Table" => &["optional", "default"],
        "Meshes" => &["optional", "values"],
        kind if KINDS.contains(&kind) => &["optional"],
        _ => {
            d.unknown_word(word, &what, KINDS);
            return None;
        }
    };
    let fields = d.body_fields(tag, &owner, known)?;
    let optional =
        fields.get("optional").and_then(|node| d.bool(node, &format!("`optional` of {owner}"))).unwrap_or(false);
    let default = match word.value.as_str() {
        "Light" => defaults::light(d, &fields),
        "Texture" => defaults::texture(d, &fields),
        "Particles" => defaults::particles(d, &fields),
        "Table" => defaults::table(d, &fields),
        _ => None,
    };
    defaults::not_optional(d, &fields);
    let kind = match word.value.as_str() {
        "Camera" => InputKind::Camera,
        "Light" => InputKind::Light,
        "Pointer" => InputKind::Pointer,
        "Table" => InputKind::Table,
        "Buffer" => InputKind::Buffer,
        "Counted" => InputKind::Counted,
        "Particles" => InputKind::Particles { attributes: attributes(d, &fields).into() },
        "Texture" => InputKind::Texture { dimension: dimension(d, &fields) },
        _ => InputKind::Meshes { values: values(d, &fields).into() },
    };
    Some(Input { name: entry.name.clone(), kind, optional, default, span: entry.name.span.to(entry.node.span) })
}

/// What each body has, declared as parameters are.
fn values(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Vec<Param> {
    let Some(node) = fields.get("values") else { return Vec::new() };
    let mut out = Vec::new();
    for entry in named(d, node, "`values` of `Meshes`") {
        if !is_identifier(&entry.name.value) || MESH_FIELDS.contains(&entry.name.value.as_str()) {
            let message = format!("a value of bodies cannot be called `{}`", entry.name.value);
            let diagnostic = Diagnostic::error(Code::BAD_NAME, message)
                .at(entry.name.span, "this name")
                .hint("a name has letters, digits and `_`, and is none that meshes have already, such as `bodies`");
            d.push(diagnostic);
            continue;
        }
        let Some(param) = params::param(d, &entry) else { continue };
        if let ParamKind::Choice(_) = param.kind {
            let message = format!("the value `{}` of bodies cannot be a `Choice`", param.name.value);
            let diagnostic = Diagnostic::error(Code::WRONG_VALUE, message)
                .at(param.span, "a word is no number")
                .hint("declare an `Int`");
            d.push(diagnostic);
            continue;
        }
        out.push(param);
    }
    out
}

fn attributes(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Vec<Attribute> {
    let Some(node) = fields.get("attributes") else { return Vec::new() };
    let what = "`attributes` of `Particles`";
    let mut out: Vec<Attribute> = Vec::new();
    for item in d.list(node, what).unwrap_or_default() {
        let Some(attribute) = attribute(d, item, what) else { continue };
        match out.iter().find(|a| a.name.value == attribute.name.value) {
            Some(first) => d.push(super::names::duplicate("the attribute", &attribute.name, first.name.span)),
            None => out.push(attribute),
        }
    }
    out
}

fn attribute(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Attribute> {
    let mut name = d.text(node, &format!("an entry of {what}"))?;
    let optional = name.value.ends_with('?');
    if optional {
        name.value.pop();
        name.span.end = name.span.end.saturating_sub(1).max(name.span.start);
    }
    if !is_identifier(&name.value) {
        let message = format!("{what}: `{}` is no name that WGSL could have", name.value);
        d.push(
            Diagnostic::error(Code::BAD_NAME, message)
                .at(name.span, "not an identifier")
                .hint("an attribute has letters, digits and `_`; a `?` at the end makes it optional"),
        );
        return None;
    }
    Some(Attribute { name, optional })
}

fn dimension(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<crate::syntax::Sp<ViewDimension>> {
    let node = fields.get("dimension")?;
    let value = d.choice(node, "`dimension` of `Texture`", DIMENSIONS)?;
    Some(crate::syntax::Sp { value, span: node.span })
}
