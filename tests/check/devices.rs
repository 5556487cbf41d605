//! `check --device`: what a browser lacks, and what other devices do. Each golden in `devices/` is the
//! whole text.

use meniscus::check::{Device, check_on};
use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::files::MemoryFiles;
use meniscus::program;
use wgpu_types::Features;

use super::cases::shared;
use crate::golden;

/// A graph that writes `count` buffers and as many storage textures in one pass, sums up 32-bit floats,
/// and has a large buffer.
fn project(buffers: usize, textures: usize, items: &str) -> MemoryFiles {
    let names = |kind: &str, n: usize| (0..n).map(|i| format!("{kind}_{i}")).collect::<Vec<_>>();
    let (lists, sheets) = (names("list", buffers), names("sheet", textures));
    let declared =
        |names: &[String], what: &str| names.iter().map(|n| format!("\"{n}\": {what}, ")).collect::<String>();
    let outputs: String = lists.iter().chain(&sheets).map(|n| format!(", \"{n}\"")).collect();
    let params = match items {
        "items" => "params: { \"items\": Int(default: 64, min: 1, max: 100000000) },",
        _ => "",
    };
    let graph = format!(
        "Graph(
    {params}
    resources: {{
        {}
        {}
        \"numbers\": Buffer(items: \"{items}\"),
        \"sum\": Texture(format: Rgba32Float, size: 16),
    }},
    passes: [
        Compute(shader: \"many.wgsl\", groups: 1),
        Compute(shader: \"write.wgsl\", groups: 1),
        Draw(shader: \"triangle.wgsl\", vertices: 3, color: [(to: \"sum\", clear: 0.0, blend: Add)]),
    ],
    outputs: [\"sum\", \"numbers\"{outputs}],
)
",
        declared(&lists, "Buffer(items: 1)"),
        declared(&sheets, "Texture(format: Rgba16Float, size: 1)")
    );
    let mut many: String = lists.iter().map(|n| format!("var<storage, read_write> {n}: array<u32>;\n")).collect();
    many.extend(sheets.iter().map(|n| format!("var {n}: texture_storage_2d<rgba16float, write>;\n")));
    many.push_str("@compute @workgroup_size(1)\nfn main() {\n");
    many.extend(lists.iter().map(|n| format!("    {n}[0] = 1u;\n")));
    many.extend(sheets.iter().map(|n| format!("    textureStore({n}, vec2u(0u), vec4f(1.0));\n")));
    many.push_str("}\n");
    let write = "var<storage, read_write> numbers: array<u32>;\n\n@compute @workgroup_size(1)\n\
        fn main() {\n    numbers[0] = 1u;\n}\n";
    shared().with("graph.ron", graph).with("many.wgsl", many).with("write.wgsl", write)
}

fn said(files: &MemoryFiles, device: &Device) -> (Diagnostics, String) {
    let mut sources = Sources::new();
    let loaded = program::load(files, &mut sources, "graph.ron", None);
    let shown = render_all(&loaded.diagnostics, &sources, Style::Plain);
    let program = loaded.program.unwrap_or_else(|| panic!("{shown}"));
    let found = check_on(&program, device);
    let text = render_all(&found, &sources, Style::Plain);
    (found, text)
}

#[test]
fn a_browser_lacks_what_its_defaults_lack() {
    let (_, text) = said(&project(9, 5, "40000000"), &Device::core());
    golden::golden("tests/check/devices/core.txt", &text);
}

#[test]
fn what_a_browser_has_is_not_told() {
    let mut blends = Device::core();
    blends.features |= Features::FLOAT32_BLENDABLE;
    let (found, text) = said(&project(8, 4, "33554432"), &blends);
    assert!(found.is_empty(), "{text}");
}

/// One more of each than there may be: none of the limits is off by one.
#[test]
fn one_more_of_anything_is_told() {
    let mut blends = Device::core();
    blends.features |= Features::FLOAT32_BLENDABLE;
    for (buffers, textures, items, word) in [
        (9, 4, "33554432", "`max_storage_buffers_per_shader_stage`, and 9 are"),
        (8, 5, "33554432", "`max_storage_textures_per_shader_stage`, and 5 are"),
        (8, 4, "33554433", "`max_storage_buffer_binding_size`, and 134217732 are"),
    ] {
        let (found, text) = said(&project(buffers, textures, items), &blends);
        assert!(found.has_errors() && text.contains(word), "{word}: {text}");
    }
}

#[test]
fn a_desktop_has_more() {
    let (found, text) = said(&project(9, 5, "40000000"), &Device::native());
    assert!(found.is_empty(), "{text}");
}

#[test]
fn what_only_another_value_needs_is_a_warning() {
    let device = Device::from_json(
        "card.json",
        r#"{"adapters": [{"name": "A card", "features": ["float32-blendable"], "limits": {}}]}"#,
    )
    .unwrap();
    let (found, text) = said(&project(1, 1, "items"), &device);
    assert!(!found.has_errors(), "{text}");
    golden::golden("tests/check/devices/other_value.txt", &text);
}
