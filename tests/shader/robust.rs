//! No text makes the program panic.

use std::fmt::Write as _;

use meniscus::diagnostic::{Style, render_all};
use proptest::prelude::*;

use super::load_text;

const SHADERS: &[&str] = &[
    "enable f16;
/* ü */ struct Params { count: u32, @size(16) scale: f32, tint: array<vec4<f32>, 2> }
var<uniform> params: Params;
var<storage, read_write> items: array<atomic<u32>>;
var<workgroup> local_sums: array<u32, 64>;
override size: u32 = 64;
fn add(n: u32) -> u32 { return atomicAdd(&items[n], 1u); }
@compute @workgroup_size(size) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    for (var i = 0u; i < params.count; i++) { local_sums[i % 64u] += add(i); }
    workgroupBarrier();
    switch id.x { case 0u, 1u: { items[0] = 1; } default: { } }
}
",
    "struct V { @builtin(position) at: vec4<f32>, @location(0) @interpolate(flat) id: u32, @location(1) uv: vec2f }
var picture: texture_2d_array<f32>; var linear_clamp: sampler; alias Color = vec4<f32>;
const corners = array<vec2<f32>, 3>(vec2(-1.0, -1.0), vec2(3.0, -1.0), vec2(-1.0, 3.0)); // 流
@vertex fn vs(@builtin(vertex_index) i: u32) -> V { return V(vec4(corners[i], 0.0, 1.0), i, corners[i]); }
@fragment fn fs(v: V) -> @location(0) Color {
    if v.uv.x < 0.0 { discard; }
    return textureSample(picture, linear_clamp, v.uv, v.id) * select(1.0, 2.0, v.id == 3u);
}
",
];

/// Loads and renders; what comes out does not matter.
fn survive(text: &str) {
    let (loaded, sources) = load_text(text);
    let shown = render_all(&loaded.diagnostics, &sources, Style::Plain);
    assert_eq!(loaded.module.is_none(), loaded.diagnostics.has_errors(), "{shown}");
    for diagnostic in loaded.diagnostics.iter() {
        for label in &diagnostic.labels {
            let text = sources.text(label.span.file);
            assert!(text.get(label.span.start as usize..label.span.end as usize).is_some(), "{label:?}");
        }
    }
}

#[test]
fn the_shaders_that_are_broken_here_are_good() {
    for text in SHADERS {
        super::module(&text.replace("items[0] = 1", "atomicStore(&items[0], 1u)"));
    }
}

#[test]
fn truncations() {
    for text in SHADERS {
        for end in (0..=text.len()).filter(|end| text.is_char_boundary(*end)) {
            survive(&text[..end]);
        }
    }
}

#[test]
fn deletions_of_a_word() {
    for text in SHADERS {
        let words: Vec<&str> = text.split_inclusive(|c: char| !c.is_alphanumeric()).collect();
        for skipped in 0..words.len() {
            let rest: String = words.iter().enumerate().filter(|(at, _)| *at != skipped).map(|(_, w)| *w).collect();
            survive(&rest);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutations(which in 0..SHADERS.len(), edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
        let mut bytes = SHADERS[which].as_bytes().to_vec();
        for (at, byte) in edits {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        survive(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn words_in_any_order(words in prop::collection::vec(0..WORDS.len(), 0..60)) {
        let mut text = String::new();
        for word in words {
            let _ = write!(text, "{} ", WORDS[word]);
        }
        survive(&text);
    }
}

const WORDS: &[&str] = &[
    "fn",
    "struct",
    "var",
    "let",
    "const",
    "override",
    "a",
    "b",
    "f32",
    "vec3",
    "<",
    ">",
    "(",
    ")",
    "{",
    "}",
    "[",
    "]",
    ";",
    ":",
    ",",
    "->",
    "=",
    "+",
    "@",
    "location",
    "0",
    "1.5",
    "#",
    "import",
    "\"a\"",
    "\n",
    "/*",
    "*/",
    "//",
    "return",
    "if",
    "else",
    "ü",
    "enable",
    "diagnostic",
    "subgroups",
    "workgroup",
    "storage",
    "uniform",
    "array",
    "compute",
    "workgroup_size",
];

#[test]
fn chains_that_would_overflow_the_stack_are_refused() {
    let body = |text: &str| format!("@compute @workgroup_size(1) fn main() {{ {text} }}");
    let many = 50_000;
    let numbered = |count: usize, item: &dyn Fn(usize) -> String| (0..count).map(item).collect::<String>();
    let texts = [
        body(&format!("var a = 1{};", " + 1".repeat(many))),
        body(&format!("let a = {}1;", "- ".repeat(many))),
        body(&format!("let a = {}1{};", "(".repeat(many), ")".repeat(many))),
        body(&format!("let a = {}1{};", "(".repeat(400), ")".repeat(400))),
        body(&format!("let a = b{};", ".x".repeat(many))),
        body(&format!("if true {{}} {}", "else if true {} ".repeat(many))),
        body(&"{".repeat(many)),
        format!("var<private> a: {}f32{};", "array<".repeat(many), ", 2>".repeat(many)),
        format!("var<private> a: {}f32{};", "array<".repeat(300), ", 1>".repeat(300)),
        numbered(many, &|n| format!("struct S{n} {{ a: S{} }}\n", n + 1)),
        numbered(many, &|n| format!("fn f{n}() {{ f{}(); }}\n", n + 1)),
        numbered(many, &|n| format!("alias T{n} = T{};\n", n + 1)),
        "/*".repeat(many),
        "#".repeat(many),
    ];
    for text in &texts {
        let (loaded, _) = load_text(text);
        assert!(loaded.diagnostics.has_errors(), "{}", &text[..60.min(text.len())]);
        survive(text);
    }
}

/// A type is spelt out as a tree, so one whose parts are shared must not fill the memory.
#[test]
fn types_that_double_with_each_line_are_not_spelt_out() {
    use meniscus::shader::reflect::GlobalKind;
    let double = |n: usize| format!("struct S{n} {{ a: S{0}, b: S{0} }}\n", n + 1);
    let text = |count: usize| {
        (0..count).map(double).collect::<String>() + &format!("struct S{count} {{ a: f32 }} var<storage> x: S0;")
    };
    assert!(matches!(super::module(&text(4)).globals[0].kind, GlobalKind::Storage { .. }));
    assert_eq!(super::module(&text(20)).globals[0].kind, GlobalKind::Other("S0".to_owned()));
}
