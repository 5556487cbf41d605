//! Wrong shaders, each with the whole text that is shown. A case is `cases/NAME.wgsl`, what is
//! shown `cases/NAME.txt`; files that cases import lie in `cases/lib/`.

use std::fs;
use std::path::Path;

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::files::MemoryFiles;
use meniscus::shader::load;

use crate::golden;

/// The `.wgsl` files of a folder under `tests/shader/`, by name.
fn texts(folder: &str) -> Vec<(String, Vec<u8>)> {
    let folder = golden::root().join("tests/shader").join(folder);
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut texts: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|end| end == "wgsl"))
        .map(|path| (path.file_stem().unwrap().to_str().unwrap().to_owned(), fs::read(&path).unwrap()))
        .collect();
    texts.sort();
    texts
}

fn files() -> MemoryFiles {
    let files = texts("cases")
        .into_iter()
        .fold(MemoryFiles::default(), |files, (name, text)| files.with(format!("{name}.wgsl"), text));
    texts("cases/lib").into_iter().fold(files, |files, (name, text)| files.with(format!("lib/{name}.wgsl"), text))
}

#[test]
fn wrong_shaders_are_told_as_expected() {
    let files = files();
    let mut reports = String::new();
    for (name, _) in texts("cases") {
        let mut sources = Sources::new();
        let loaded = load(&files, &mut sources, &format!("{name}.wgsl"), None);
        assert!(loaded.module.is_none() && loaded.diagnostics.has_errors(), "{name} is not wrong");
        for diagnostic in loaded.diagnostics.iter() {
            assert!(diagnostic.labels.iter().any(|l| l.primary), "{name}: no place");
            let start = diagnostic.message.chars().next().unwrap();
            assert!(!start.is_uppercase() && !diagnostic.message.contains("naga"), "{name}: {}", diagnostic.message);
        }
        let shown = render_all(&loaded.diagnostics, &sources, Style::Plain);
        let path = Path::new("tests/shader/cases").join(format!("{name}.txt"));
        if let Err(report) = golden::compare(&path, &shown) {
            reports += &format!("{report}\n\n");
        }
    }
    assert!(reports.is_empty(), "{reports}");
}

/// A text that nothing expects any more would be taken for tested.
#[test]
fn every_expected_text_has_its_case() {
    let folder = golden::root().join("tests/shader/cases");
    let names = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let orphans: Vec<_> = names
        .filter(|path| path.extension().is_some_and(|end| end == "txt") && !path.with_extension("wgsl").exists())
        .collect();
    assert_eq!(orphans, [] as [std::path::PathBuf; 0]);
}
