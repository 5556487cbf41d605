//! `passes:`: everything but the targets of draws.

use super::draw;
use super::values::{bind, check_path, expr, exprs_of, named, path, place, tagged, view, view_fields};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::expr::Expr;
use crate::graph::model::{
    Clear, Compute, Copy, Extent, If, Name, Node as Pass, NodeKind, Repeat, ShaderRef, Steps, Use,
};
use crate::syntax::{Body, Decoder, Fields, Node, Sp, Tagged};

const KINDS: &[&str] = &["Compute", "Draw", "Fullscreen", "Copy", "Clear", "Use", "Repeat", "If", "Steps"];

/// The entries of a list of passes that can be read.
pub(super) fn list(d: &mut Decoder<'_>, node: &Node, what: &str) -> Vec<Pass> {
    d.list(node, what).unwrap_or_default().iter().filter_map(|item| pass(d, item, what)).collect()
}

fn pass(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Pass> {
    let (word, tag) = tagged(d, node, &format!("an entry of {what}"), "a pass such as `Compute(...)` or `Use(...)`")?;
    let kind = match word.value.as_str() {
        "Compute" => NodeKind::Compute(compute(d, tag)?),
        "Draw" => NodeKind::Draw(draw::draw(d, tag, true)?),
        "Fullscreen" => NodeKind::Fullscreen(draw::draw(d, tag, false)?),
        "Copy" => NodeKind::Copy(copy(d, tag)?),
        "Clear" => NodeKind::Clear(clear(d, tag, node)?),
        "Use" => NodeKind::Use(part(d, tag)?),
        "Repeat" => NodeKind::Repeat(repeat(d, tag)?),
        "If" => NodeKind::If(branch(d, tag)?),
        "Steps" => NodeKind::Steps(steps(d, tag)?),
        _ => {
            d.unknown_word(word, &format!("an entry of {what}"), KINDS);
            return None;
        }
    };
    Some(Pass { kind, span: node.span, word: word.span })
}

/// The label of a pass; no WGSL name, but part of paths such as `shapes.grid.sort/scan`.
pub(super) fn label(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<Name> {
    let name = d.text(fields.get("name")?, &place(fields, "name"))?;
    if name.value.is_empty() || name.value.contains(|c: char| c == '/' || c.is_control()) {
        let message = match name.value.escape_debug().to_string() {
            empty if empty.is_empty() => format!("the name of {} is empty", fields.owner),
            text => format!("{} cannot be called `{text}`", fields.owner),
        };
        let hint = "a pass's name is not empty and has no `/`, which separates it from the path of its part";
        d.push(Diagnostic::error(Code::BAD_NAME, message).at(name.span, "this name").hint(hint));
        return None;
    }
    Some(name)
}

/// `"x.wgsl"`, `"x.wgsl#entry"`, `"x.wgsl#vertex,fragment"`.
pub(super) fn shader(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Option<ShaderRef> {
    let node = fields.require(d, "shader")?;
    let what = place(fields, "shader");
    let text = d.string(node, &what)?;
    let part = |start: usize, end: usize| {
        let mut span = text.inner;
        if text.exact {
            span.start = text.inner.start + start as u32;
            span.end = text.inner.start + end as u32;
        }
        Sp { value: text.value[start..end].to_string(), span }
    };
    let hash = text.value.find('#').unwrap_or(text.value.len());
    let path = part(0, hash);
    let mut entries = Vec::new();
    let mut start = hash + 1;
    while start <= text.value.len() {
        let end = text.value[start..].find(',').map_or(text.value.len(), |i| start + i);
        let trimmed = text.value[start..end].trim_start();
        let from = end - trimmed.len();
        entries.push(part(from, from + trimmed.trim_end().len()));
        start = end + 1;
    }
    if path.value.trim().is_empty() {
        d.push(
            Diagnostic::error(Code::WRONG_VALUE, format!("{what} names no file"))
                .at(node.span, "the path of a WGSL file is expected"),
        );
        return None;
    }
    if let Some(bad) = entries.iter().find(|e| !super::values::is_identifier(&e.value)) {
        let message = format!("{what}: `{}` is not the name of an entry point", bad.value);
        d.push(
            Diagnostic::error(Code::BAD_NAME, message)
                .at(node.span, "names of entry points follow the `#`, separated by `,`"),
        );
        return None;
    }
    Some(ShaderRef { path, entries })
}

fn compute(d: &mut Decoder<'_>, tag: &Tagged) -> Option<Compute> {
    let fields = d.body_fields(tag, "`Compute`", &["shader", "each", "groups", "name", "bind"])?;
    let (name, shader, bind) = (label(d, &fields), shader(d, &fields), bind(d, &fields));
    let extent = match (fields.entry("each"), fields.entry("groups")) {
        (Some((each, _)), Some((groups, _))) => {
            let message = "`Compute` has both `each` and `groups`";
            d.push(
                Diagnostic::error(Code::BAD_PASS, message)
                    .at(groups.span, "workgroups")
                    .see(each.span, "threads")
                    .hint("`each` counts threads, `groups` counts workgroups: keep one"),
            );
            None
        }
        (Some((_, node)), None) => each(d, node),
        (None, Some((_, node))) => groups(d, node),
        (None, None) if !fields.lacks(&["each", "groups"]) => None,
        (None, None) => {
            let message = "`Compute` lacks the field `each` or `groups`";
            d.push(
                Diagnostic::error(Code::MISSING_FIELD, message)
                    .at(fields.head, "how many threads or workgroups?")
                    .hint("`each: Texel(\"x\")`, `each: Item(\"x\")`, `each: Threads(x, y, z)`, or `groups: ...`"),
            );
            None
        }
    };
    Some(Compute { name, shader: shader?, bind, extent: extent? })
}

fn each(d: &mut Decoder<'_>, node: &Node) -> Option<Extent> {
    let what = "`each` of `Compute`";
    let (word, tag) = tagged(d, node, what, "`Texel(...)`, `Item(...)` or `Threads(...)`")?;
    match word.value.as_str() {
        "Texel" => {
            let thing = d.single(tag, "`Texel`", "the name of a texture, or a `View(...)`,")?;
            view(d, thing, "`Texel`").map(Extent::Texel)
        }
        "Item" => {
            let thing = d.single(tag, "`Item`", "the name of a buffer in a string")?;
            path(d, thing, "`Item`").map(Extent::Item)
        }
        "Threads" => match &tag.body {
            Body::Items(items) if (1..=3).contains(&items.len()) => {
                let parts: Vec<Option<Expr>> = items.iter().map(|item| expr(d, item, "`Threads`")).collect();
                parts.into_iter().collect::<Option<Vec<Expr>>>().map(Extent::Threads)
            }
            _ => {
                d.push(
                    Diagnostic::error(Code::WRONG_VALUE, "`Threads`: expected 1 to 3 counts")
                        .at(tag.head, "expected 1 to 3 counts"),
                );
                None
            }
        },
        "Each" => {
            let message = "`each` of `Compute`: `Each` counts workgroups or draws, not threads";
            d.push(
                Diagnostic::error(Code::UNKNOWN_VARIANT, message)
                    .at(word.span, "not for threads")
                    .hint("write `Item(...)` for one thread for each item, or `groups: Each(...)` for one workgroup"),
            );
            None
        }
        _ => {
            d.unknown_word(word, what, &["Texel", "Item", "Threads"]);
            None
        }
    }
}

fn groups(d: &mut Decoder<'_>, node: &Node) -> Option<Extent> {
    let what = "`groups` of `Compute`";
    if let Some(name) = each_of(d, node, what) {
        return name.map(Extent::GroupsEach);
    }
    exprs_of(d, node, what, &[1, 2, 3], "1 to 3 counts").map(Extent::Groups)
}

/// `Each("x")`: absent if it is something else, `Some(None)` if it cannot be read.
pub(super) fn each_of(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Option<Name>> {
    let tag = node.as_tagged().filter(|t| t.name.as_ref().is_some_and(|n| n.value == "Each"))?;
    let thing = d.single(tag, what, "the name of a thing in a string");
    Some(thing.and_then(|thing| path(d, thing, what)))
}

fn copy(d: &mut Decoder<'_>, tag: &Tagged) -> Option<Copy> {
    let fields = d.body_fields(tag, "`Copy`", &["from", "to", "name"])?;
    let name = label(d, &fields);
    let from = fields.require(d, "from").and_then(|node| view(d, node, "`from` of `Copy`"));
    let to = fields.require(d, "to").and_then(|node| view(d, node, "`to` of `Copy`"));
    Some(Copy { name, from: from?, to: to? })
}

/// `Clear("x")`, `Clear("x", 0)` or `Clear(of: "x", value: 0)`.
fn clear(d: &mut Decoder<'_>, tag: &Tagged, node: &Node) -> Option<Clear> {
    if let Body::Items(items) = &tag.body
        && (1..=2).contains(&items.len())
    {
        let of = view(d, items.first()?, "`Clear`");
        let value = items.get(1).map(|value| clear_value(d, value, "the value of `Clear`"));
        return Some(Clear { name: None, of: of?, value: value.unwrap_or_else(|| Some(zero(node)))? });
    }
    let fields = d.body_fields(tag, "`Clear`", &["of", "mip", "layer", "value", "name"])?;
    let name = label(d, &fields);
    let of = view_fields(d, &fields, "of", node);
    let value = fields.get("value").map(|value| clear_value(d, value, "`value` of `Clear`"));
    Some(Clear { name, of: of?, value: value.unwrap_or_else(|| Some(zero(node)))? })
}

fn zero(node: &Node) -> Vec<Expr> {
    let kind = crate::graph::expr::ExprKind::Literal(crate::graph::value::Value::Int(0));
    vec![Expr { kind, span: node.head() }]
}

/// One value for all channels, or four.
pub(super) fn clear_value(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Vec<Expr>> {
    exprs_of(d, node, what, &[1, 4], "one value for all channels, or a tuple of 4")
}

fn part(d: &mut Decoder<'_>, tag: &Tagged) -> Option<Use> {
    let fields = d.body_fields(tag, "`Use`", &["graph", "name", "bind", "params"])?;
    let graph = fields.require(d, "graph").and_then(|node| d.text(node, "`graph` of `Use`"));
    let name = fields.get("name").map(|node| d.text(node, "`name` of `Use`"));
    let mut binds = Vec::new();
    if let Some(node) = fields.get("bind") {
        for entry in named(d, node, "`bind` of `Use`") {
            let what = format!("`{}` in `bind` of `Use`", entry.name.value);
            let good = check_path(d, &entry.name, "`bind` of `Use`");
            let thing = path(d, entry.node, &what);
            binds.extend(thing.filter(|_| good).map(|thing| (entry.name, thing)));
        }
    }
    let mut params = Vec::new();
    if let Some(node) = fields.get("params") {
        for entry in named(d, node, "`params` of `Use`") {
            let good = check_path(d, &entry.name, "`params` of `Use`");
            let value = expr(d, entry.node, &format!("`{}` in `params` of `Use`", entry.name.value));
            params.extend(value.filter(|_| good).map(|value| (entry.name, value)));
        }
    }
    let graph = graph?;
    // Without a name it is called as its file.
    let name = name.unwrap_or_else(|| {
        let file = graph.value.rsplit(['/', '\\']).next().unwrap_or_default();
        Some(Sp { value: file.strip_suffix(".ron").unwrap_or(file).to_string(), span: graph.span })
    })?;
    Some(Use { graph, name, bind: binds, params })
}

fn repeat(d: &mut Decoder<'_>, tag: &Tagged) -> Option<Repeat> {
    let fields = d.body_fields(tag, "`Repeat`", &["times", "index", "swap", "passes"])?;
    let times = fields.require(d, "times").and_then(|node| expr(d, node, "`times` of `Repeat`"));
    let index = fields.get("index").and_then(|node| d.text(node, "`index` of `Repeat`"));
    let swap = fields.get("swap").map(|node| swaps(d, node)).unwrap_or_default();
    let passes = fields.require(d, "passes").map(|node| list(d, node, "`passes` of `Repeat`")).unwrap_or_default();
    Some(Repeat { times: times?, index, swap, passes })
}

fn swaps(d: &mut Decoder<'_>, node: &Node) -> Vec<Sp<Vec<Name>>> {
    let what = "`swap` of `Repeat`";
    let mut out: Vec<Sp<Vec<Name>>> = Vec::new();
    for item in d.list(node, what).unwrap_or_default() {
        let Some(items) = d.items(item, what, "tuples of two names or more", 2..=usize::MAX) else { continue };
        let names: Vec<Option<Name>> = items.iter().map(|name| path(d, name, what)).collect();
        let Some(names) = names.into_iter().collect::<Option<Vec<Name>>>() else { continue };
        for (i, name) in names.iter().enumerate() {
            let earlier = out.iter().flat_map(|s| &s.value).chain(&names[..i]).find(|n| n.value == name.value);
            if let Some(earlier) = earlier {
                let diagnostic = super::names::duplicate("the swapped name", name, earlier.span);
                d.push(diagnostic);
            }
        }
        out.push(Sp { value: names, span: item.span });
    }
    out
}

fn branch(d: &mut Decoder<'_>, tag: &Tagged) -> Option<If> {
    let fields = d.body_fields(tag, "`If`", &["test", "then", "else"])?;
    let test = fields.require(d, "test").and_then(|node| expr(d, node, "`test` of `If`"));
    let then = fields.require(d, "then").map(|node| list(d, node, "`then` of `If`")).unwrap_or_default();
    let otherwise = fields.get("else").map(|node| list(d, node, "`else` of `If`")).unwrap_or_default();
    Some(If { test: test?, then, otherwise })
}

fn steps(d: &mut Decoder<'_>, tag: &Tagged) -> Option<Steps> {
    let fields = d.body_fields(tag, "`Steps`", &["rate", "key", "passes", "name"])?;
    let name = label(d, &fields);
    let rate = fields.require(d, "rate").and_then(|node| match node.as_word() {
        Some(word) if word.value == "PerFrame" => Some(None),
        Some(word) => {
            d.unknown_word(word, "`rate` of `Steps`", &["PerFrame"]);
            None
        }
        None => expr(d, node, "`rate` of `Steps`").map(Some),
    });
    let key = fields.get("key").and_then(|node| expr(d, node, "`key` of `Steps`"));
    let passes = fields.require(d, "passes").map(|node| list(d, node, "`passes` of `Steps`")).unwrap_or_default();
    Some(Steps { name, rate: rate?, key, passes })
}
