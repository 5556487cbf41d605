//! `Draw` and `Fullscreen`: geometry, targets, blending, depth and stencil.

use super::passes::{clear_value, each_of, label, shader};
use super::resources::COMPARES;
use super::values::{bind, expr, expr_field, exprs_of, path_field, place, tagged, view, view_fields};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::expr::{Expr, ExprKind};
use crate::graph::model::{
    Blend, BlendComponent, Compare, Count, Covering, Depth, Draw, Face, Factor, Indirect, Name, Operation, Stencil,
    StencilOperation, Target, Topology,
};
use crate::graph::value::Value;
use crate::syntax::{Decoder, Fields, Kind, Node, Sp, Tagged};

const COMMON: &[&str] = &["shader", "color", "depth", "samples", "region", "name", "bind"];
const GEOMETRY: &[&str] =
    &["vertices", "instances", "indices", "draw", "meshes", "tags", "only", "topology", "cull", "front"];

const TOPOLOGIES: &[(&str, Topology)] = &[
    ("PointList", Topology::PointList),
    ("LineList", Topology::LineList),
    ("LineStrip", Topology::LineStrip),
    ("TriangleList", Topology::TriangleList),
    ("TriangleStrip", Topology::TriangleStrip),
];

const COVERINGS: &[(&str, Covering)] = &[("Opaque", Covering::Opaque), ("Blended", Covering::Blended)];

const FACTORS: &[(&str, Factor)] = &[
    ("Zero", Factor::Zero),
    ("One", Factor::One),
    ("Src", Factor::Src),
    ("OneMinusSrc", Factor::OneMinusSrc),
    ("SrcAlpha", Factor::SrcAlpha),
    ("OneMinusSrcAlpha", Factor::OneMinusSrcAlpha),
    ("Dst", Factor::Dst),
    ("OneMinusDst", Factor::OneMinusDst),
    ("DstAlpha", Factor::DstAlpha),
    ("OneMinusDstAlpha", Factor::OneMinusDstAlpha),
];

const OPERATIONS: &[(&str, Operation)] = &[
    ("Add", Operation::Add),
    ("Subtract", Operation::Subtract),
    ("ReverseSubtract", Operation::ReverseSubtract),
    ("Min", Operation::Min),
    ("Max", Operation::Max),
];

const STENCIL_OPERATIONS: &[(&str, StencilOperation)] = &[
    ("Keep", StencilOperation::Keep),
    ("Zero", StencilOperation::Zero),
    ("Replace", StencilOperation::Replace),
    ("Invert", StencilOperation::Invert),
    ("IncrementClamp", StencilOperation::IncrementClamp),
    ("DecrementClamp", StencilOperation::DecrementClamp),
    ("IncrementWrap", StencilOperation::IncrementWrap),
    ("DecrementWrap", StencilOperation::DecrementWrap),
];

/// A `Draw`, or a `Fullscreen`, which has no geometry.
pub(super) fn draw(d: &mut Decoder<'_>, tag: &Tagged, has_geometry: bool) -> Option<Draw> {
    let owner = if has_geometry { "`Draw`" } else { "`Fullscreen`" };
    let known = if has_geometry { [COMMON, GEOMETRY].concat() } else { COMMON.to_vec() };
    let fields = d.body_fields(tag, owner, &known)?;
    let geometry = if has_geometry { geometry(d, &fields) } else { Geometry::default() };
    let color = fields.get("color").map(|node| targets(d, node, owner)).unwrap_or_default();
    let region = fields.get("region").and_then(|node| {
        let what = place(&fields, "region");
        let value = exprs_of(d, node, &what, &[4], "x, y, width and height in pixels")?;
        Some(Sp { value, span: node.span })
    });
    let draw = Draw {
        name: label(d, &fields),
        bind: bind(d, &fields),
        vertices: geometry.vertices,
        instances: geometry.instances,
        indices: geometry.indices,
        indirect: geometry.indirect,
        meshes: geometry.meshes,
        tags: geometry.tags,
        only: geometry.only,
        topology: geometry.topology.unwrap_or(Topology::TriangleList),
        cull: geometry.cull,
        front_ccw: !geometry.is_clockwise,
        color,
        depth: fields.get("depth").and_then(|node| depth(d, node, owner)),
        samples: expr_field(d, &fields, "samples"),
        region,
        shader: shader(d, &fields)?,
    };
    Some(draw)
}

#[derive(Default)]
struct Geometry {
    vertices: Option<Count>,
    instances: Option<Count>,
    indices: Option<Name>,
    indirect: Option<Indirect>,
    meshes: Option<Name>,
    tags: Option<Vec<Name>>,
    only: Option<Covering>,
    topology: Option<Topology>,
    cull: Option<Face>,
    is_clockwise: bool,
}

fn geometry(d: &mut Decoder<'_>, fields: &Fields<'_>) -> Geometry {
    const FACES: &[(&str, Option<Face>)] = &[("None", None), ("Front", Some(Face::Front)), ("Back", Some(Face::Back))];
    const FRONTS: &[(&str, bool)] = &[("Ccw", false), ("Cw", true)];
    if fields.lacks(&["vertices", "draw", "indices", "meshes"]) {
        d.push(
            Diagnostic::error(Code::MISSING_FIELD, "`Draw` lacks the field `vertices`, `indices`, `draw` or `meshes`")
                .at(fields.head, "how many vertices?")
                .hint(
                    "`vertices: 4`, `vertices: Each(\"x\")`, `indices: \"x\"`, `draw: Indirect(buffer: \"x\")` or \
                     `meshes: \"x\"`",
                ),
        );
    }
    beside_meshes(d, fields);
    if let Some((name, node)) = fields.entry("draw") {
        for other in ["vertices", "instances"] {
            if let Some((given, _)) = fields.entry(other)
                && !node.is_invalid()
            {
                let message = format!("`Draw` has both `draw` and `{other}`");
                d.push(
                    Diagnostic::error(Code::BAD_PASS, message)
                        .at(given.span, "a count given here")
                        .see(name.span, "the arguments come from a buffer")
                        .hint(format!("leave `{other}` out: the buffer holds it")),
                );
            }
        }
    }
    Geometry {
        vertices: fields.get("vertices").and_then(|node| count(d, node, &place(fields, "vertices"))),
        instances: fields.get("instances").and_then(|node| count(d, node, &place(fields, "instances"))),
        indices: path_field(d, fields, "indices"),
        indirect: fields.get("draw").and_then(|node| indirect(d, node)),
        meshes: path_field(d, fields, "meshes"),
        tags: fields.get("tags").and_then(|node| tags(d, node, &place(fields, "tags"))),
        only: fields.get("only").and_then(|node| d.choice(node, &place(fields, "only"), COVERINGS)),
        topology: fields.get("topology").and_then(|node| d.choice(node, &place(fields, "topology"), TOPOLOGIES)),
        cull: fields.get("cull").and_then(|node| d.choice(node, &place(fields, "cull"), FACES)).flatten(),
        is_clockwise: fields
            .get("front")
            .and_then(|node| d.choice(node, &place(fields, "front"), FRONTS))
            .unwrap_or(false),
    }
}

/// Meshes bring their own vertices, triangles and instances.
fn beside_meshes(d: &mut Decoder<'_>, fields: &Fields<'_>) {
    let chooses = ["tags", "only"].into_iter().find_map(|name| Some((name, fields.entry(name)?.0)));
    let fault = match (fields.entry("meshes"), chooses) {
        (Some((meshes, _)), _) => {
            let others = ["vertices", "instances", "indices", "draw", "topology"];
            let Some((name, (other, _))) = others.iter().find_map(|o| Some((o, fields.entry(o)?))) else { return };
            Diagnostic::error(Code::BAD_PASS, format!("`Draw` has both `meshes` and `{name}`"))
                .at(other.span, "not beside `meshes`")
                .see(meshes.span, "draws the triangles of meshes")
                .hint(format!("leave `{name}` out: meshes are triangles, as many as there are"))
        }
        (None, Some((name, given))) => {
            Diagnostic::error(Code::BAD_PASS, format!("`{name}` says which meshes are drawn"))
                .at(given.span, "without `meshes`")
                .hint("say `meshes: \"...\"`")
        }
        (None, None) => return,
    };
    d.push(fault);
}

fn tags(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Vec<Name>> {
    let all: Vec<Option<Name>> = d.list(node, what)?.iter().map(|item| d.text(item, what)).collect();
    all.into_iter().collect()
}

fn count(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Count> {
    match each_of(d, node, what) {
        Some(name) => name.map(Count::Each),
        None => expr(d, node, what).map(Count::Expr),
    }
}

fn indirect(d: &mut Decoder<'_>, node: &Node) -> Option<Indirect> {
    let (word, tag) = tagged(d, node, "`draw` of `Draw`", "`Indirect(buffer:, item:)`")?;
    if word.value != "Indirect" {
        d.unknown_word(word, "`draw` of `Draw`", &["Indirect"]);
        return None;
    }
    let fields = d.body_fields(tag, "`Indirect`", &["buffer", "item"])?;
    let item = expr_field(d, &fields, "item");
    _ = fields.require(d, "buffer");
    Some(Indirect { buffer: path_field(d, &fields, "buffer")?, item, span: node.span })
}

fn targets(d: &mut Decoder<'_>, node: &Node, owner: &str) -> Vec<Target> {
    let what = format!("`color` of {owner}");
    d.list(node, &what).unwrap_or_default().iter().filter_map(|item| target(d, item, &what)).collect()
}

/// `"z"`, `View(...)` or `(to: "z", clear: 0.0, ...)`.
fn target(d: &mut Decoder<'_>, node: &Node, what: &str) -> Option<Target> {
    let is_fields = matches!(&node.kind, Kind::Tagged(Tagged { name: None, .. }));
    if !is_fields {
        let to = view(d, node, &format!("an entry of {what}"))?;
        return Some(Target { to, clear: None, blend: None, write: [true; 4], resolve: None, span: node.span });
    }
    let fields = d.fields(node, "a target", &["to", "mip", "layer", "clear", "blend", "write", "resolve"])?;
    let to = view_fields(d, &fields, "to", node);
    let clear = fields
        .get("clear")
        .and_then(|value| Some(Sp { value: clear_value(d, value, "`clear` of a target")?, span: value.span }));
    let blend = fields.get("blend").and_then(|value| blend(d, value));
    let write = fields.get("write").and_then(|value| channels(d, value)).unwrap_or([true; 4]);
    let resolve = fields.get("resolve").and_then(|value| view(d, value, "`resolve` of a target"));
    Some(Target { to: to?, clear, blend, write, resolve, span: node.span })
}

fn channels(d: &mut Decoder<'_>, node: &Node) -> Option<[bool; 4]> {
    let what = "`write` of a target";
    let text = d.string(node, what)?;
    let mut out = [false; 4];
    for c in text.value.chars() {
        match "rgba".find(c) {
            Some(i) if !out[i] => out[i] = true,
            _ => {
                let message = format!("{what}: `{}` does not name channels", text.value);
                d.push(
                    Diagnostic::error(Code::WRONG_VALUE, message)
                        .at(node.span, "expected some of the letters r, g, b, a, each once")
                        .hint("for example \"rgb\" or \"a\""),
                );
                return None;
            }
        }
    }
    Some(out)
}

const fn component(source: Factor, target: Factor, operation: Operation) -> BlendComponent {
    BlendComponent { source, target, operation }
}

const fn both(component: BlendComponent) -> Option<Blend> {
    Some(Blend { color: component, alpha: component })
}

/// Blends by one word.
const BLENDS: &[(&str, Option<Blend>)] = &[
    ("None", None),
    (
        "Alpha",
        Some(Blend {
            color: component(Factor::SrcAlpha, Factor::OneMinusSrcAlpha, Operation::Add),
            alpha: component(Factor::One, Factor::OneMinusSrcAlpha, Operation::Add),
        }),
    ),
    ("Premultiplied", both(component(Factor::One, Factor::OneMinusSrcAlpha, Operation::Add))),
    ("Add", both(component(Factor::One, Factor::One, Operation::Add))),
    ("Multiply", both(component(Factor::Dst, Factor::Zero, Operation::Add))),
    ("Min", both(component(Factor::One, Factor::One, Operation::Min))),
    ("Max", both(component(Factor::One, Factor::One, Operation::Max))),
];

fn blend(d: &mut Decoder<'_>, node: &Node) -> Option<Sp<Blend>> {
    let tag = node.as_tagged().filter(|t| t.name.as_ref().is_some_and(|n| n.value == "Blend"));
    let Some(tag) = tag else {
        let value = d.choice(node, "`blend` of a target", BLENDS)??;
        return Some(Sp { value, span: node.span });
    };
    let fields = d.body_fields(tag, "`Blend`", &["src", "dst", "op", "src_alpha", "dst_alpha", "op_alpha"])?;
    let mut factor = |name: &str| fields.get(name).and_then(|node| d.choice(node, &place(&fields, name), FACTORS));
    let (src, dst) = (factor("src"), factor("dst"));
    let (src_alpha, dst_alpha) = (factor("src_alpha"), factor("dst_alpha"));
    let mut operation =
        |name: &str| fields.get(name).and_then(|node| d.choice(node, &place(&fields, name), OPERATIONS));
    let (op, op_alpha) = (operation("op").unwrap_or(Operation::Add), operation("op_alpha"));
    _ = (fields.require(d, "src"), fields.require(d, "dst"));
    let color = component(src?, dst?, op);
    let alpha = component(src_alpha.unwrap_or(color.source), dst_alpha.unwrap_or(color.target), op_alpha.unwrap_or(op));
    Some(Sp { value: Blend { color, alpha }, span: node.span })
}

/// `Nearest(x)`, `Farthest(x)`, `Test(x)` or `Depth(...)`. Depth is reversed: near is 1.
fn depth(d: &mut Decoder<'_>, node: &Node, owner: &str) -> Option<Depth> {
    const WORDS: &[&str] = &["Nearest", "Farthest", "Test", "Depth"];
    let what = format!("`depth` of {owner}");
    let (word, tag) = tagged(d, node, &what, "`Nearest(...)`, `Farthest(...)`, `Test(...)` or `Depth(...)`")?;
    let (compare, write, clear) = match word.value.as_str() {
        "Nearest" => (Compare::Greater, true, Some(0.0)),
        "Farthest" => (Compare::Less, true, Some(1.0)),
        "Test" => (Compare::GreaterEqual, false, None),
        "Depth" => return full_depth(d, tag, node),
        _ => {
            d.unknown_word(word, &what, WORDS);
            return None;
        }
    };
    let thing = d.single(tag, &format!("`{}`", word.value), "the name of a texture, or a `View(...)`,")?;
    let to = view(d, thing, &format!("`{}`", word.value))?;
    let clear = clear.map(|x| Expr { kind: ExprKind::Literal(Value::Float(x)), span: node.span });
    Some(Depth { to, compare, write, clear, bias: None, stencil: None, span: node.span })
}

fn full_depth(d: &mut Decoder<'_>, tag: &Tagged, node: &Node) -> Option<Depth> {
    let known = ["to", "mip", "layer", "compare", "write", "clear", "bias", "stencil"];
    let fields = d.body_fields(tag, "`Depth`", &known)?;
    let compare = fields.get("compare").and_then(|node| d.choice(node, &place(&fields, "compare"), COMPARES));
    let write = fields.get("write").and_then(|node| d.bool(node, &place(&fields, "write")));
    let bias = fields.get("bias").and_then(|node| {
        let items = d.items(node, &place(&fields, "bias"), "a constant and a slope", 2..=2)?;
        let constant = expr(d, items.first()?, &place(&fields, "bias"));
        let slope = expr(d, items.get(1)?, &place(&fields, "bias"));
        Some((constant?, slope?))
    });
    let stencil = fields.get("stencil").and_then(|node| stencil(d, node));
    let clear = expr_field(d, &fields, "clear");
    let to = view_fields(d, &fields, "to", node)?;
    Some(Depth {
        to,
        compare: compare.unwrap_or(Compare::Greater),
        write: write.unwrap_or(true),
        clear,
        bias,
        stencil,
        span: node.span,
    })
}

fn stencil(d: &mut Decoder<'_>, node: &Node) -> Option<Stencil> {
    let known = ["compare", "pass", "fail", "depth_fail", "reference", "read_mask", "write_mask", "clear"];
    let fields = d.fields(node, "`stencil`", &known)?;
    let mut operation = |name: &str| {
        let node = fields.get(name)?;
        d.choice(node, &place(&fields, name), STENCIL_OPERATIONS)
    };
    let (pass, fail, depth_fail) = (operation("pass"), operation("fail"), operation("depth_fail"));
    let mut mask = |name: &str| {
        let value = d.int_within(fields.get(name)?, &place(&fields, name), 0, 0xff)?;
        u32::try_from(value).ok()
    };
    let (read_mask, write_mask) = (mask("read_mask"), mask("write_mask"));
    let compare = fields.get("compare").and_then(|node| d.choice(node, &place(&fields, "compare"), COMPARES));
    let zero = || Expr { kind: ExprKind::Literal(Value::Int(0)), span: node.head() };
    Some(Stencil {
        compare: compare.unwrap_or(Compare::Always),
        pass: pass.unwrap_or(StencilOperation::Keep),
        fail: fail.unwrap_or(StencilOperation::Keep),
        depth_fail: depth_fail.unwrap_or(StencilOperation::Keep),
        reference: expr_field(d, &fields, "reference").unwrap_or_else(zero),
        read_mask: read_mask.unwrap_or(0xff),
        write_mask: write_mask.unwrap_or(0xff),
        clear: expr_field(d, &fields, "clear"),
    })
}
