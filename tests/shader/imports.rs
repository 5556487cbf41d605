//! Imports that work, and what cannot be shown as a text file.

use std::path::PathBuf;
use std::sync::Arc;

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::files::{Files, MemoryFiles};
use meniscus::shader::{Loaded, load};

use super::{entry, load_files, module};

const MAIN: &str = "@compute @workgroup_size(1) fn main() { out[0] = one() + two(); }\n";
const OUT: &str = "var<storage, read_write> out: array<f32>;\n";

fn paths(loaded: &Loaded) -> Vec<String> {
    loaded.read.iter().map(|p| p.display().to_string()).collect()
}

#[test]
fn a_file_is_taken_once_however_often_it_is_imported() {
    let files = MemoryFiles::default()
        .with("main.wgsl", format!("#import \"a.wgsl\"\n#import \"b.wgsl\"\n#import \"./a.wgsl\"\n{MAIN}"))
        .with("a.wgsl", "#import \"c.wgsl\"\nfn one() -> f32 { return c(); }")
        .with("b.wgsl", "#import \"c.wgsl\"\nfn two() -> f32 { return c(); }")
        .with("c.wgsl", format!("{OUT}fn c() -> f32 {{ return 1.0; }}"));
    let (loaded, _) = load_files(files);
    assert!(loaded.diagnostics.is_empty());
    assert_eq!(paths(&loaded), ["main.wgsl", "a.wgsl", "c.wgsl", "b.wgsl"]);
    let module = loaded.module.unwrap();
    assert_eq!(module.files, loaded.read);
    assert_eq!(entry(&module, "main").calls, ["c", "one", "two"]);
}

#[test]
fn cycles_do_no_harm() {
    let files = MemoryFiles::default()
        .with("main.wgsl", format!("#import \"a.wgsl\"\n{OUT}{MAIN}"))
        .with("a.wgsl", "#import \"b.wgsl\"\n#import \"a.wgsl\"\nfn one() -> f32 { return 1.0; }")
        .with("b.wgsl", "#import \"main.wgsl\"\n#import \"a.wgsl\"\nfn two() -> f32 { return one(); }");
    let (loaded, sources) = load_files(files.clone());
    assert_eq!(render_all(&loaded.diagnostics, &sources, Style::Plain), "");
    assert_eq!(paths(&loaded), ["main.wgsl", "a.wgsl", "b.wgsl"]);
    assert_eq!(loaded.module.unwrap().entries.len(), 1);

    let loaded = load(&files, &mut Sources::new(), "b.wgsl", None);
    assert_eq!(loaded.module.unwrap().entries.len(), 0, "the entry point is in a file that is only imported");
}

#[test]
fn comments_hold_no_imports() {
    let text = "// #import \"no.wgsl\"\n/* \n#import \"no.wgsl\"\n/* */ #import \"no.wgsl\" */\n\
                /* but */ #import \"yes.wgsl\" // this\n";
    let files = MemoryFiles::default()
        .with("main.wgsl", format!("{text}{OUT}{MAIN}"))
        .with("yes.wgsl", "fn one() -> f32 { return 1.0; } fn two() -> f32 { return 2.0; } // no line end");
    let (loaded, sources) = load_files(files);
    assert_eq!(render_all(&loaded.diagnostics, &sources, Style::Plain), "");
    assert_eq!(paths(&loaded), ["main.wgsl", "yes.wgsl"]);
}

#[test]
fn directives_of_imports_move_to_the_top() {
    let files = MemoryFiles::default()
        .with(
            "main.wgsl",
            "#import \"half.wgsl\"\ndiagnostic(off, derivative_uniformity);\nvar<storage, read_write> out: array<f16>;
             @diagnostic(off, derivative_uniformity) @compute @workgroup_size(1) fn main() { out[0] = half(); }",
        )
        .with(
            "half.wgsl",
            "// one half\nenable f16;\ndiagnostic(off, derivative_uniformity);\nfn half() -> f16 { return 0.5h; }",
        );
    let (loaded, sources) = load_files(files);
    assert_eq!(render_all(&loaded.diagnostics, &sources, Style::Plain), "");
    let module = loaded.module.unwrap();
    let (_, out) = module.global("out").unwrap();
    assert_eq!((sources.path(out.span.file), sources.snippet(out.span)), ("main.wgsl", "out"));
}

#[test]
fn binding_numbers_are_ignored() {
    let text = |a: &str, b: &str| {
        format!(
            "{a} var<storage, read_write> out: array<f32>; {b} var<uniform> x: f32;
                 @compute @workgroup_size(1) fn main() {{ out[0] = x; }}"
        )
    };
    let plain = module(&text("", ""));
    for (a, b) in [
        ("@group(0) @binding(0)", "@group(0) @binding(0)"),
        ("@group(9) @binding(9)", ""),
        ("", "@binding(3) @group(1)"),
    ] {
        let other = module(&text(a, b));
        let bindings = |m: &meniscus::shader::reflect::Module| {
            m.globals.iter().map(|g| (g.name.clone(), g.binding)).collect::<Vec<_>>()
        };
        assert_eq!(bindings(&plain), bindings(&other));
    }
}

#[test]
fn paths_are_looked_for_beside_then_under_shaders() {
    let files = MemoryFiles::default()
        .with(
            "project/shaders/method/main.wgsl",
            format!("#import \"near.wgsl\"\n#import \"lib/far.wgsl\"\n{OUT}{MAIN}"),
        )
        .with("project/shaders/method/near.wgsl", "fn one() -> f32 { return 1.0; }")
        .with("project/shaders/lib/far.wgsl", "fn two() -> f32 { return 2.0; }");
    let mut sources = Sources::new();
    let graph = PathBuf::from("project/graphs/g.ron");
    let loaded = load(&files, &mut sources, "method/main.wgsl", Some(&graph));
    assert_eq!(render_all(&loaded.diagnostics, &sources, Style::Plain), "");
    let expected =
        ["project/shaders/method/main.wgsl", "project/shaders/method/near.wgsl", "project/shaders/lib/far.wgsl"];
    assert_eq!(paths(&loaded), expected);
    assert_eq!(loaded.module.unwrap().path, PathBuf::from(expected[0]));
}

#[test]
fn the_carried_library_is_found_last() {
    let Some(name) = meniscus::files::library().find(|path| path.starts_with("shaders/lib/")) else {
        panic!("the program carries no shader library");
    };
    let name = name.strip_prefix("shaders/").unwrap();
    let files = MemoryFiles::default().with("main.wgsl", format!("#import \"{name}\"\n"));
    let (loaded, _) = load_files(files);
    assert!(paths(&loaded)[1].replace('\\', "/").starts_with("<library>/shaders/lib/"), "{:?}", loaded.read);
    let files = MemoryFiles::default().with("main.wgsl", format!("#import \"{name}\"\n")).with(name, "");
    let (loaded, _) = load_files(files);
    assert_eq!(paths(&loaded), ["main.wgsl", name], "a file of the person's own wins");
}

#[test]
fn what_is_missing_is_watched() {
    let files = MemoryFiles::default().with("p/shaders/m/main.wgsl", "#import \"no.wgsl\"\n");
    let loaded = load(&files, &mut Sources::new(), "p/shaders/m/main.wgsl", None);
    assert!(loaded.module.is_none());
    let read = paths(&loaded);
    assert_eq!(read[..2], ["p/shaders/m/main.wgsl", "p/shaders/m/no.wgsl"]);
    assert!(read.iter().any(|p| p == "p/shaders/no.wgsl"), "{read:?}");

    let loaded = load(&files, &mut Sources::new(), "none.wgsl", None);
    let diagnostic = &loaded.diagnostics.0[0];
    assert_eq!((diagnostic.id.as_str(), diagnostic.labels.len()), ("file-missing", 0));
    assert_eq!(diagnostic.message, "there is no shader `none.wgsl`");
    assert!(paths(&loaded).contains(&"none.wgsl".to_owned()));
}

#[test]
fn text_that_is_not_utf8_is_told() {
    let files = MemoryFiles::default()
        .with("main.wgsl", "\n#import \"latin.wgsl\"\n")
        .with("latin.wgsl", b"// one\n// caf\xe9\n");
    let (loaded, sources) = load_files(files.clone());
    let expected = "\
error[file-unreadable]: `latin.wgsl` is not UTF-8 text: line 2 has bytes that are no character
  ┌─ main.wgsl:2:10
  │
2 │ #import \"latin.wgsl\"
  │          ^^^^^^^^^^ imported here
  │
  = hint: save the file as UTF-8

1 error
";
    assert_eq!(render_all(&loaded.diagnostics, &sources, Style::Plain), expected);
    assert_eq!(paths(&loaded), ["main.wgsl", "latin.wgsl"]);
    let loaded = load(&files, &mut Sources::new(), "latin.wgsl", None);
    assert_eq!(loaded.diagnostics.0[0].labels.len(), 0);
}

/// A file that is there and cannot be read.
struct Locked(MemoryFiles);

impl Files for Locked {
    fn read(&self, path: &std::path::Path) -> std::io::Result<Arc<[u8]>> {
        match path.ends_with("locked.wgsl") {
            true => Err(std::io::ErrorKind::PermissionDenied.into()),
            false => self.0.read(path),
        }
    }

    fn exists(&self, path: &std::path::Path) -> bool {
        path.ends_with("locked.wgsl") || self.0.exists(path)
    }
}

#[test]
fn files_that_cannot_be_read_are_told() {
    let files = Locked(MemoryFiles::default().with("main.wgsl", "#import \"locked.wgsl\"\n"));
    let loaded = load(&files, &mut Sources::new(), "main.wgsl", None);
    let diagnostic = &loaded.diagnostics.0[0];
    assert_eq!((diagnostic.id.as_str(), diagnostic.labels.len()), ("file-unreadable", 1));
    assert!(diagnostic.message.starts_with("`locked.wgsl` cannot be read: "), "{}", diagnostic.message);
}

/// The library is looked through for a name that nothing declares.
#[test]
fn a_name_of_the_library_brings_its_import() {
    let text = |path: &str| str::from_utf8(meniscus::files::library_file(path.as_ref()).unwrap()).unwrap();
    let mut paths = meniscus::files::library().filter(|path| path.starts_with("shaders/lib/"));
    let (path, name) = paths
        .find_map(|path| {
            let name = text(path).lines().find_map(|line| line.strip_prefix("fn ")?.split('(').next())?;
            Some((path.strip_prefix("shaders/")?, name))
        })
        .unwrap();
    let (loaded, _) = super::load_text(&format!("@fragment fn main() {{ {name}(); }}"));
    let hint = format!("`{path}` declares it: `#import \"{path}\"`");
    assert_eq!(loaded.diagnostics.0[0].hints, [hint]);
}
