//! What is read is what was written: the short forms, the defaults, the order.

use meniscus::diagnostic::{Code, Sources, Style, explain, render_all};
use meniscus::graph::expr::ExprKind;
use meniscus::graph::model::{
    Compare, Count, Draw, Extent, Factor, Graph, InputKind, Mips, NodeKind, Operation, ParamKind, ResourceKind,
    ViewDimension,
};
use meniscus::graph::value::Value;

use crate::golden::root;
use crate::language::cases::{read, read_text};

fn everything() -> (Graph, Sources) {
    let (graph, diagnostics, sources) = read(&root().join("tests/language/valid/everything.ron"));
    assert!(diagnostics.is_empty(), "{}", render_all(&diagnostics, &sources, Style::Plain));
    (graph.unwrap(), sources)
}

/// The draws at the top of a graph.
fn draws(graph: &Graph) -> Vec<&Draw> {
    let mut draws = Vec::new();
    for node in &graph.passes {
        if let NodeKind::Draw(draw) = &node.kind {
            draws.push(draw);
        }
    }
    draws
}

#[test]
fn sections_keep_their_order_and_their_kinds() {
    let (graph, _) = everything();
    assert_eq!(graph.about.as_deref(), Some("everything \"at once\""));
    let kinds: Vec<&str> = graph.inputs.iter().map(|i| i.kind.name()).collect();
    assert_eq!(kinds, ["Camera", "Light", "Pointer", "Table", "Particles", "Texture", "Texture", "Buffer", "Counted"]);
    let optional: Vec<bool> = graph.inputs.iter().map(|i| i.optional).collect();
    assert_eq!(optional, [false, true, false, false, false, false, false, false, true]);
    let InputKind::Particles { attributes } = &graph.inputs[4].kind else { panic!() };
    assert_eq!(
        attributes.iter().map(|a| (a.name.value.as_str(), a.optional)).collect::<Vec<_>>(),
        [("position", false), ("color", true)]
    );
    let InputKind::Texture { dimension: Some(dimension) } = &graph.inputs[5].kind else { panic!() };
    assert_eq!(dimension.value, ViewDimension::Cube);
    let params: Vec<&str> = graph.params.iter().map(|p| p.kind.name()).collect();
    assert_eq!(params, ["Int", "Int", "Float", "Bool", "Choice", "Vec2", "Vec3", "Vec4", "Color", "Color"]);
    assert_eq!(graph.lets.len(), 5);
    assert!(
        graph.resources.iter().take(10).all(|r| !r.state) && graph.resources[10].state && graph.resources[11].state
    );
    let outputs: Vec<(&str, &str)> =
        graph.outputs.iter().map(|o| (o.name.value.as_str(), o.of.value.as_str())).collect();
    assert_eq!(outputs, [("color", "pyramid"), ("start", "sort.start")]);
}

#[test]
fn parameters_have_typed_defaults() {
    let (graph, _) = everything();
    let default = |name: &str| {
        let param = graph.params.iter().find(|p| p.name.value == name).unwrap();
        param.default.as_ref().map(|d| d.value.clone())
    };
    assert_eq!(default("iterations"), Some(Value::Int(5)));
    assert_eq!(default("given"), None);
    assert_eq!(default("sigma"), Some(Value::Float(5.0)));
    assert_eq!(default("weights"), Some(Value::Word("depth".into())));
    assert_eq!(default("offset"), Some(Value::vec([0.0, 1.0])));
    assert_eq!(default("tint"), Some(Value::vec([1.0, 1.0, 1.0, 0.5])));
    assert_eq!(graph.params[0].max.as_ref().unwrap().value, Value::Int(64));
    let ParamKind::Choice(words) = &graph.params[4].kind else { panic!() };
    assert_eq!(words.iter().map(|w| w.value.as_str()).collect::<Vec<_>>(), ["depth", "distance"]);
}

#[test]
fn resources_have_their_defaults() {
    let (graph, _) = everything();
    let kind = |name: &str| &graph.resources.iter().find(|r| r.name.value == name).unwrap().kind;
    let ResourceKind::Texture { size, dimension, layers, mips, samples, .. } = kind("z") else { panic!() };
    assert_eq!((size.len(), *dimension, mips.is_none(), samples.is_none()), (1, ViewDimension::D2, true, true));
    assert_eq!(layers.as_ref().unwrap().kind, ExprKind::Literal(Value::Int(2)));
    let ResourceKind::Texture { mips: Some(Mips::Auto(_)), size, .. } = kind("pyramid") else { panic!() };
    assert_eq!(size.len(), 2);
    let ResourceKind::Texture { mips: Some(Mips::Count(_)), dimension: ViewDimension::Cube, .. } = kind("levels")
    else {
        panic!()
    };
    let ResourceKind::Texture { size, dimension: ViewDimension::D3, .. } = kind("volume") else { panic!() };
    assert_eq!(size.len(), 3);
    let ResourceKind::Like(name) = kind("like_part") else { panic!() };
    assert_eq!(name.value, "grid.cells");
    let plain = graph.samplers.last().unwrap();
    assert!(plain.linear && plain.mip_linear && plain.compare.is_none() && plain.anisotropy == 1);
    assert!(!graph.samplers[0].mip_linear);
}

#[test]
fn depth_words_are_written_out_for_reversed_depth() {
    let (graph, _) = everything();
    let words: Vec<_> = draws(&graph)
        .iter()
        .filter_map(|draw| draw.depth.as_ref())
        .map(|depth| (depth.compare, depth.write, depth.clear.as_ref().map(|c| c.kind.clone())))
        .collect();
    let literal = |x: f64| Some(ExprKind::Literal(Value::Float(x)));
    assert_eq!(
        words,
        [
            (Compare::Greater, true, literal(0.0)),
            (Compare::Less, true, literal(1.0)),
            (Compare::GreaterEqual, false, None),
            (Compare::Less, false, literal(1.0)),
        ]
    );
    let stencil = draws(&graph)[3].depth.as_ref().unwrap().stencil.as_ref().unwrap();
    assert_eq!((stencil.compare, stencil.read_mask, stencil.write_mask), (Compare::Equal, 15, 255));
}

#[test]
fn targets_keep_order_blend_and_channels() {
    let (graph, _) = everything();
    let draw = draws(&graph)[0];
    assert_eq!(draw.shader.path.value, "e.wgsl");
    assert_eq!(draw.shader.entries.iter().map(|e| e.value.as_str()).collect::<Vec<_>>(), ["vertex", "fragment"]);
    assert!(matches!((&draw.vertices, &draw.instances), (Some(Count::Expr(_)), Some(Count::Each(_)))));
    assert!(!draw.front_ccw);
    let targets = &draw.color;
    assert_eq!(targets[0].blend.unwrap_add(), (Factor::One, Factor::One, Operation::Add));
    assert!(targets[1].blend.is_none() && targets[1].to.mip.is_some());
    assert_eq!(targets[2].write, [true, true, true, false]);
    assert_eq!(targets[2].clear.as_ref().unwrap().value.len(), 4);
    assert_eq!(targets[3].resolve.as_ref().unwrap().of.value, "pyramid");
    let own = targets[4].blend.as_ref().unwrap().value;
    assert_eq!(
        (own.color.source, own.alpha.target, own.alpha.operation),
        (Factor::SrcAlpha, Factor::Zero, Operation::Max)
    );
    assert_eq!(draw.region.as_ref().unwrap().value.len(), 4);
}

/// The colour part of a blend.
trait ColorOf {
    fn unwrap_add(&self) -> (Factor, Factor, Operation);
}

impl ColorOf for Option<meniscus::graph::model::Sp<meniscus::graph::model::Blend>> {
    fn unwrap_add(&self) -> (Factor, Factor, Operation) {
        let color = self.as_ref().unwrap().value.color;
        (color.source, color.target, color.operation)
    }
}

#[test]
fn passes_of_every_kind_are_read() {
    let (graph, sources) = everything();
    let count = |test: fn(&NodeKind) -> bool| graph.passes.iter().filter(|node| test(&node.kind)).count();
    assert_eq!(count(|k| matches!(k, NodeKind::Use(_))), 2);
    assert_eq!(count(|k| matches!(k, NodeKind::Clear(_))), 5);
    assert_eq!(count(|k| matches!(k, NodeKind::Copy(_))), 1);
    assert_eq!(count(|k| matches!(k, NodeKind::Compute(_))), 8);
    assert_eq!(count(|k| matches!(k, NodeKind::Draw(_))), 5);
    assert_eq!(count(|k| matches!(k, NodeKind::If(_))), 2);
    assert_eq!(count(|k| matches!(k, NodeKind::Repeat(_))), 1);
    let rates: Vec<bool> = graph
        .passes
        .iter()
        .filter_map(|n| match &n.kind {
            NodeKind::Steps(steps) => Some(steps.rate.is_some()),
            _ => None,
        })
        .collect();
    assert_eq!(rates, [false, true, true]);
    let NodeKind::Use(part) = &graph.passes[0].kind else { panic!() };
    assert_eq!((part.name.value.as_str(), sources.snippet(part.name.span)), ("grid", "parts/grid.ron"));
    let extents: Vec<&Extent> = graph
        .passes
        .iter()
        .filter_map(|n| match &n.kind {
            NodeKind::Compute(compute) => Some(&compute.extent),
            _ => None,
        })
        .collect();
    assert!(matches!(extents[1], Extent::Texel(view) if view.mip.is_some() && view.layer.is_some()));
    assert!(matches!(extents[3], Extent::Threads(list) if list.len() == 3));
    assert!(matches!(extents[6], Extent::Groups(list) if list.len() == 1));
    assert!(matches!(extents[7], Extent::GroupsEach(name) if name.value == "list"));
}

/// Spans of names cover the text between the quotes; spans of passes the whole entry.
#[test]
fn spans_cover_what_was_written() {
    let (graph, _, sources) = read_text(
        r#"Graph(resources: {"z": Texture(format: R32Float, size: "viewport")}, passes: [Compute(shader: "a.wgsl#main", each: Texel("z"))], outputs: ["z"])"#,
    );
    let graph = graph.unwrap();
    assert_eq!(sources.snippet(graph.span), "Graph(");
    assert_eq!(sources.snippet(graph.resources[0].name.span), "z");
    assert_eq!(sources.snippet(graph.resources[0].span), r#"z": Texture(format: R32Float, size: "viewport")"#);
    let node = &graph.passes[0];
    assert_eq!(sources.snippet(node.span), r#"Compute(shader: "a.wgsl#main", each: Texel("z"))"#);
    assert_eq!(sources.snippet(node.word), "Compute");
    let NodeKind::Compute(compute) = &node.kind else { panic!() };
    assert_eq!(sources.snippet(compute.shader.path.span), "a.wgsl");
    assert_eq!(sources.snippet(compute.shader.entries[0].span), "main");
}

/// A pass that cannot be read hides no other, and errors come in the order of the file.
#[test]
fn one_bad_pass_hides_no_other() {
    let (graph, diagnostics, _) = read(&root().join("tests/language/cases/all_at_once.ron"));
    let ids: Vec<&str> = diagnostics.iter().map(|d| d.id.as_str()).collect();
    for id in ["syntax", "unknown-field", "unknown-variant", "duplicate", "expression-syntax"] {
        assert!(ids.contains(&id), "{id} is missing in {ids:?}");
    }
    assert!(graph.unwrap().passes.len() >= 2);
    let starts: Vec<u32> =
        diagnostics.iter().map(|d| d.labels.iter().find(|l| l.primary).unwrap().span.start).collect();
    assert!(starts.is_sorted(), "{starts:?}");
}

/// The graphs that the program carries are read as they are, and `ron` reads them too.
#[test]
fn shipped_graphs_read_without_errors() {
    let mut folders = vec![root().join("graphs")];
    let mut count = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "ron") {
                let (graph, diagnostics, sources) = read(&path);
                assert!(diagnostics.is_empty(), "{}", render_all(&diagnostics, &sources, Style::Plain));
                assert!(graph.is_some());
                std::fs::read_to_string(&path).unwrap().parse::<ron::Value>().unwrap();
                count += 1;
            }
        }
    }
    assert!(count > 5, "only {count} graphs found");
}

/// `explain` has something to say about every id that reading and evaluating give.
#[test]
fn ids_of_form_and_expressions_are_explained() {
    let ids = [
        Code::FILE_MISSING,
        Code::FILE_UNREADABLE,
        Code::SYNTAX,
        Code::UNKNOWN_FIELD,
        Code::MISSING_FIELD,
        Code::WRONG_VALUE,
        Code::UNKNOWN_VARIANT,
        Code::DUPLICATE,
        Code::BAD_NAME,
        Code::EXPRESSION_SYNTAX,
        Code::EXPRESSION_TYPE,
        Code::FRACTIONAL,
        Code::NOT_KNOWN_WHEN_PLANNING,
        Code::CYCLE,
    ];
    for id in ids {
        let text = explain(id.as_str()).unwrap_or_default();
        assert!(text.len() > 100, "`explain {}` says only {text:?}", id.as_str());
    }
}
