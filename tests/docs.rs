//! The documentation says what is so: its examples are read and checked, its tables name everything that there is, its
//! links lead somewhere.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};

use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::files::DiskFiles;
use meniscus::graph::expr::Function;
use meniscus::plan::fields;
use meniscus::{check, format, graph, program, scene};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn text(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The fenced blocks of a language, with the line of each.
fn blocks(document: &str, language: &str) -> Vec<(usize, String)> {
    let text = text(document);
    let mut found = Vec::new();
    let mut open: Option<(usize, String, bool)> = None;
    for (at, line) in text.lines().enumerate() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(word)) => open = Some((at + 2, String::new(), word == language)),
            (Some(_), Some(_)) => found.extend(open.take().filter(|o| o.2).map(|(line, text, _)| (line, text))),
            (Some((_, text, _)), None) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "{document}: a block is not closed");
    found
}

/// A block as a whole graph; absent if it is a scene.
fn whole(block: &str) -> Option<String> {
    let starts = |words: &[&str]| words.iter().any(|word| block.starts_with(word));
    if starts(&["Scene("]) {
        None
    } else if starts(&["Graph("]) {
        Some(block.to_owned())
    } else if starts(&["let:", "resources:", "samplers:", "params:", "inputs:", "stats:"]) {
        Some(format!("Graph(\n{block}passes: [], outputs: [],\n)"))
    } else {
        Some(format!("Graph(\npasses: [\n{block}], outputs: [],\n)"))
    }
}

fn rendered(diagnostics: &Diagnostics, sources: &Sources) -> String {
    render_all(diagnostics, sources, Style::Plain)
}

#[test]
fn every_example_of_a_graph_can_be_read() {
    let mut seen = 0;
    for document in ["README.md", "docs/language.md"] {
        for (line, block) in blocks(document, "ron") {
            let Some(whole) = whole(&block) else { continue };
            let mut sources = Sources::new();
            let file = sources.add("example.ron".to_owned(), whole.as_str());
            let (graph, diagnostics) = graph::read(&sources, file, Path::new("example.ron"));
            assert!(graph.is_some(), "{document}:{line}");
            let shown = rendered(&diagnostics, &sources);
            assert!(shown.is_empty(), "{document}:{line}\n{shown}");
            seen += 1;
        }
    }
    assert!(seen >= 8, "only {seen} examples were found");
}

#[test]
fn every_example_of_a_scene_can_be_read() {
    let mut seen = 0;
    for document in ["README.md", "docs/language.md"] {
        for (line, block) in blocks(document, "ron").into_iter().filter(|(_, block)| block.starts_with("Scene(")) {
            let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
            let scene = scene::read(Path::new("scene.ron"), block.as_bytes(), &mut sources, &mut diagnostics);
            let shown = rendered(&diagnostics, &sources);
            assert!(scene.is_some() && shown.is_empty(), "{document}:{line}\n{shown}");
            seen += 1;
        }
    }
    assert!(seen >= 2, "only {seen} examples were found");
}

#[test]
fn the_readme_names_every_command() {
    use clap::CommandFactory as _;
    let readme = text("README.md");
    let section = readme.split("## Commands").nth(1).unwrap().split("\n## ").next().unwrap();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `")?.split([' ', '`']).next());
    let mut named: Vec<&str> = rows.collect();
    let cli = meniscus::cli::Cli::command();
    let mut there: Vec<&str> = cli.get_subcommands().map(|command| command.get_name()).collect();
    named.sort_unstable();
    there.sort_unstable();
    assert_eq!(named, there);
}

/// Whole graphs in the documentation are files of `docs/tour/`, which have their shaders beside them.
#[test]
fn every_whole_example_is_a_file_that_checks() {
    let folder = root().join("docs/tour");
    let files: Vec<(PathBuf, String)> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.clone(), fs::read_to_string(path).unwrap()))
        .collect();
    let mut shown_files = Vec::new();
    for (document, language) in [("README.md", "ron"), ("README.md", "wgsl"), ("docs/language.md", "ron")] {
        for (line, block) in blocks(document, language) {
            let is_whole = language == "wgsl" || block.starts_with("Graph(");
            if !is_whole {
                continue;
            }
            let file = files.iter().find(|(_, text)| *text == block);
            shown_files.push(file.unwrap_or_else(|| panic!("{document}:{line} is no file of docs/tour")).0.clone());
        }
    }
    for path in shown_files.iter().filter(|path| path.extension().is_some_and(|end| end == "ron")) {
        let mut sources = Sources::new();
        let loaded = program::load(&DiskFiles, &mut sources, path.to_str().unwrap(), None);
        let mut diagnostics = loaded.diagnostics;
        diagnostics.extend(loaded.program.as_ref().map(check::check).unwrap_or_default());
        let shown = rendered(&diagnostics, &sources);
        assert!(loaded.program.is_some() && shown.is_empty(), "{}\n{shown}", path.display());
    }
}

#[test]
fn the_language_page_names_everything() {
    let page = text("docs/language.md");
    let named = |word: &str| {
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
        page.match_indices(word).any(|(at, _)| {
            let before = page[..at].chars().next_back().is_some_and(is_part);
            let after = page[at + word.len()..].chars().next().is_some_and(is_part);
            let line_start = page[..at].rfind('\n').map_or(0, |n| n + 1);
            // In code: an odd number of backquotes before it on its line.
            !before && !after && page[line_start..at].matches('`').count() % 2 == 1
        })
    };
    let tables = [fields::CAMERA, fields::LIGHT, fields::POINTER, fields::PARTICLES, fields::FRAME];
    let words = (tables.iter().flat_map(|table| table.iter().map(|(name, _)| *name)))
        .chain(fields::SAMPLERS.iter().copied())
        .chain(Function::ALL.iter().map(|(name, _)| *name))
        .chain(format::NAMED.iter().map(|(name, _)| *name));
    let missing: Vec<&str> = words.filter(|word| !named(word)).collect();
    assert!(missing.is_empty(), "docs/language.md does not name {missing:?}");
    assert!(!named("no_such_field_at_all"), "the search finds what is not there");
}

/// `[text](target)` and `![text](target)` of a document, without those that leave the repository.
fn links(document: &str) -> Vec<String> {
    let text = text(document);
    let targets =
        text.match_indices("](").filter_map(|(at, _)| text[at + 2..].split_once(')').map(|(t, _)| t.to_owned()));
    targets.filter(|target| !target.contains("://")).collect()
}

/// The anchor that a heading gets.
fn anchor(heading: &str) -> String {
    let plain = heading.trim_start_matches('#').trim().to_lowercase();
    plain
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

#[test]
fn every_link_leads_somewhere() {
    let mut documents = vec![PathBuf::from("README.md"), PathBuf::from("CHANGELOG.md")];
    for folder in ["docs", "docs/methods"] {
        let entries = fs::read_dir(root().join(folder)).unwrap();
        let pages = entries.map(|entry| Path::new(folder).join(entry.unwrap().file_name()));
        documents.extend(pages.filter(|path| path.extension().is_some_and(|end| end == "md")));
    }
    let (mut seen, mut dead) = (0, Vec::new());
    for document in documents {
        let name = document.to_str().unwrap();
        for link in links(name) {
            let (path, heading) = link.split_once('#').map_or((link.as_str(), None), |(p, h)| (p, Some(h)));
            let target = if path.is_empty() { document.clone() } else { document.parent().unwrap().join(path) };
            seen += 1;
            if !root().join(&target).exists() {
                dead.push(format!("{name}: {link} is not there"));
            } else if let Some(heading) = heading {
                let page = text(target.to_str().unwrap());
                let mut headings = page.lines().filter(|line| line.starts_with('#')).map(anchor);
                if !headings.any(|has| has == heading) {
                    dead.push(format!("{name}: {link} has no such heading"));
                }
            }
        }
    }
    assert!(dead.is_empty(), "{}", dead.join("\n"));
    assert!(seen >= 20, "only {seen} links were found");
}

/// Names that swap in a step stand for the newest after it, also when the step is the first to use them.
#[test]
fn state_of_the_tour_turns_with_each_step() {
    use meniscus::plan::model::ObjectRef;
    let path = root().join("docs/tour/heat.ron");
    let program = program::load(&DiskFiles, &mut Sources::new(), path.to_str().unwrap(), None).program.unwrap();
    let plan = meniscus::plan::instantiate(&program, &check::stand_in(&program)).unwrap();
    assert_eq!(plan.rings.len(), 1);
    assert_eq!(plan.rings[0].turn, 1, "one swap a step");
    let read = plan.passes.last().unwrap().accesses.iter().find(|a| a.read).unwrap().object;
    assert_eq!(read, ObjectRef::Ring { ring: 0, index: 0 }, "the first name is the newest");
}

/// A sort with an odd number of swaps is all right in a step: it keeps nothing for the next one.
#[test]
fn parts_that_swap_can_stand_in_steps() {
    let text = r#"Graph(
        state: { "keys": Buffer(items: 1000), "sorted": Buffer(items: 1000) },
        resources: { "color": Texture(format: Rgba16Float, size: "viewport") },
        passes: [
            Steps(rate: PerFrame, passes: [
                Clear("keys"),
                Use(graph: "parts/radix_sort.ron", name: "sort", params: {"bits": 15}),
                Copy(from: "sort.pairs", to: "sorted"),
            ]),
            Clear("color"),
        ],
        outputs: ["color", "sorted"],
    )"#;
    let files = meniscus::files::MemoryFiles::default().with("sorted.ron", text);
    let mut sources = Sources::new();
    let loaded = program::load(&files, &mut sources, "sorted.ron", None);
    let mut diagnostics = loaded.diagnostics;
    diagnostics.extend(loaded.program.as_ref().map(check::check).unwrap_or_default());
    assert!(!diagnostics.has_errors(), "{}", rendered(&diagnostics, &sources));
}

/// What a pass says of samples is what its targets have.
#[test]
fn samples_of_a_pass_agree_with_its_targets() {
    let graph = |samples: &str| {
        format!(
            r#"Graph(
                resources: {{
                    "many": Texture(format: Rgba16Float, size: "viewport", samples: 4),
                    "color": Texture(format: Rgba16Float, size: "viewport"),
                }},
                passes: [Fullscreen(shader: "grey.wgsl"{samples}, color: [(to: "many", clear: 0.0, resolve: "color")])],
                outputs: ["color"],
            )"#
        )
    };
    let shader = "@fragment fn grey() -> @location(0) vec4f { return vec4f(0.5); }";
    for (said, message) in [
        ("", None),
        (", samples: 4", None),
        (", samples: 1", Some("the pass says 1 samples, and its targets have 4")),
        (", samples: \"no_such_name\"", Some("nothing is called `no_such_name`")),
    ] {
        let files = meniscus::files::MemoryFiles::default().with("a.ron", graph(said)).with("grey.wgsl", shader);
        let program = program::load(&files, &mut Sources::new(), "a.ron", None).program.unwrap();
        let found: Vec<String> = check::check(&program).0.into_iter().map(|d| d.message).collect();
        assert_eq!(found, message.map(str::to_owned).into_iter().collect::<Vec<_>>(), "{said}");
    }
}
