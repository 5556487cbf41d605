//! `resources:`, `state:` and `samplers:`.

use super::values::{self, Named, exprs_of, path, place, tagged};
use crate::diagnostic::{Code, Diagnostic};
use crate::format;
use crate::graph::expr::Expr;
use crate::graph::model::{Address, Compare, Mips, Resource, ResourceKind, Sampler, ViewDimension};
use crate::syntax::{Decoder, Fields, Sp};

const KINDS: &[&str] = &["Texture", "Buffer", "Counted", "Like"];

const DIMENSIONS: &[(&str, ViewDimension)] =
    &[("D2", ViewDimension::D2), ("Cube", ViewDimension::Cube), ("D3", ViewDimension::D3)];

pub(super) const COMPARES: &[(&str, Compare)] = &[
    ("Never", Compare::Never),
    ("Less", Compare::Less),
    ("Equal", Compare::Equal),
    ("LessEqual", Compare::LessEqual),
    ("Greater", Compare::Greater),
    ("NotEqual", Compare::NotEqual),
    ("GreaterEqual", Compare::GreaterEqual),
    ("Always", Compare::Always),
];

pub(super) fn resource(d: &mut Decoder<'_>, entry: &Named<'_>, state: bool) -> Option<Resource> {
    let owner = format!("`{}`", entry.name.value);
    let (word, tag) = tagged(d, entry.node, &owner, "`Texture(...)`, `Buffer(...)`, `Counted(...)` or `Like(...)`")?;
    let kind = match word.value.as_str() {
        "Texture" => {
            let known = ["format", "size", "dimension", "layers", "mips", "samples"];
            let fields = d.body_fields(tag, &owner, &known)?;
            texture(d, &fields)?
        }
        "Buffer" => ResourceKind::Buffer { items: amount(d, tag, &owner, "items")? },
        "Counted" => counted(d, tag, &owner)?,
        "Like" => {
            let node = d.single(tag, &owner, "the name of a texture or buffer in a string")?;
            ResourceKind::Like(path(d, node, &format!("`Like` of {owner}"))?)
        }
        _ => {
            d.unknown_word(word, &owner, KINDS);
            return None;
        }
    };
    Some(Resource { name: entry.name.clone(), state, kind, span: entry.name.span.to(entry.node.span) })
}

fn amount(d: &mut Decoder<'_>, tag: &crate::syntax::Tagged, owner: &str, field: &str) -> Option<Expr> {
    let fields = d.body_fields(tag, owner, &[field])?;
    let node = fields.require(d, field)?;
    values::expr(d, node, &place(&fields, field))
}

fn counted(d: &mut Decoder<'_>, tag: &crate::syntax::Tagged, owner: &str) -> Option<ResourceKind> {
    let fields = d.body_fields(tag, owner, &["capacity", "empty"])?;
    let empty = values::label(d, &fields, "empty");
    let node = fields.require(d, "capacity")?;
    let capacity = values::expr(d, node, &place(&fields, "capacity"))?;
    Some(ResourceKind::Counted { capacity, empty })
}

fn texture(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<ResourceKind> {
    let format = fields.require(d, "format").and_then(|node| {
        let value = d.choice(node, &place(fields, "format"), format::NAMED)?;
        Some(Sp { value, span: node.span })
    });
    let size = fields
        .require(d, "size")
        .and_then(|node| exprs_of(d, node, &place(fields, "size"), &[2, 3], "one size, or a tuple of 2 or 3"));
    let dimension = fields.get("dimension").and_then(|node| d.choice(node, &place(fields, "dimension"), DIMENSIONS));
    let mips = fields.get("mips").and_then(|node| match node.as_word() {
        Some(word) if word.value == "Auto" => Some(Mips::Auto(node.span)),
        _ => values::expr(d, node, &place(fields, "mips")).map(Mips::Count),
    });
    let layers = values::expr_field(d, fields, "layers");
    let samples = values::expr_field(d, fields, "samples");
    Some(ResourceKind::Texture {
        format: format?,
        size: size?,
        dimension: dimension.unwrap_or(ViewDimension::D2),
        layers,
        mips,
        samples,
    })
}

pub(super) fn sampler(d: &mut Decoder<'_>, entry: &Named<'_>) -> Option<Sampler> {
    const FILTERS: &[(&str, bool)] = &[("Linear", true), ("Nearest", false)];
    const ADDRESSES: &[(&str, Address)] =
        &[("Clamp", Address::Clamp), ("Repeat", Address::Repeat), ("Mirror", Address::Mirror)];
    let owner = format!("the sampler `{}`", entry.name.value);
    let (word, tag) = tagged(d, entry.node, &owner, "`Sampler(...)`")?;
    if word.value != "Sampler" {
        d.unknown_word(word, &owner, &["Sampler"]);
        return None;
    }
    let fields = d.body_fields(tag, &owner, &["filter", "mips", "address", "compare", "anisotropy"])?;
    let linear =
        fields.get("filter").and_then(|node| d.choice(node, &place(&fields, "filter"), FILTERS)).unwrap_or(true);
    let mip_linear =
        fields.get("mips").and_then(|node| d.choice(node, &place(&fields, "mips"), FILTERS)).unwrap_or(linear);
    let address = fields.get("address").and_then(|node| d.choice(node, &place(&fields, "address"), ADDRESSES));
    let compare = fields.get("compare").and_then(|node| d.choice(node, &place(&fields, "compare"), COMPARES));
    let anisotropy =
        fields.entry("anisotropy").and_then(|(_, node)| d.int_within(node, &place(&fields, "anisotropy"), 1, 16));
    if anisotropy.is_some_and(|a| a > 1)
        && !(linear && mip_linear)
        && let Some((name, _)) = fields.entry("anisotropy")
    {
        let message = format!("{owner} has anisotropy without linear filters");
        d.push(
            Diagnostic::error(Code::WRONG_VALUE, message)
                .at(name.span, "needs linear filters")
                .hint("use `filter: Linear, mips: Linear`, or leave `anisotropy` out"),
        );
    }
    Some(Sampler {
        name: entry.name.clone(),
        linear,
        mip_linear,
        address: address.unwrap_or(Address::Clamp),
        compare,
        anisotropy: anisotropy.and_then(|a| u16::try_from(a).ok()).unwrap_or(1),
    })
}
