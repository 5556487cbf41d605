//! Methods are data: nothing under `src/` knows a paper, a fluid or a kernel.

use std::path::{Path, PathBuf};

/// What no source file may say, beside the names of the shipped methods.
const WORDS: &[&str] = &[
    "iwasaki",
    "imai",
    "hoetzlein",
    "xiao",
    "johanson",
    "plane fit",
    "plane_fit",
    "metaball",
    "surfel",
    "caustic",
    "splash",
    "fluid",
    "water",
    "projected grid",
    "projected_grid",
    "poly6",
    "yu and turk",
];

fn files(folder: &Path, end: &str, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).expect("the repository's own folders can be read");
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            files(&path, end, found);
        } else if path.extension().is_some_and(|e| e == end) {
            found.push(path);
        }
    }
}

/// The forbidden words of a text, with their lines.
fn named(text: &str, words: &[String]) -> Vec<String> {
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let lower = line.to_lowercase();
        let said = words.iter().filter(|word| lower.contains(word.as_str()));
        found.extend(said.map(|word| format!("line {}: `{word}`", number + 1)));
    }
    found
}

#[test]
fn sources_name_no_method() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut words: Vec<String> = WORDS.iter().map(|word| (*word).to_owned()).collect();
    for entry in std::fs::read_dir(root.join("graphs")).expect("graphs are there").flatten() {
        if entry.path().is_file() {
            words.extend(entry.path().file_stem().map(|stem| stem.to_string_lossy().to_lowercase()));
        }
    }
    let mut sources = Vec::new();
    for end in ["rs", "wgsl", "ron"] {
        files(&root.join("src"), end, &mut sources);
    }
    assert!(sources.len() > 50, "the sources were not found");
    let mut faults = Vec::new();
    for path in sources {
        let text = std::fs::read_to_string(&path).expect("sources are UTF-8");
        faults.extend(named(&text, &words).into_iter().map(|fault| format!("{}: {fault}", path.display())));
    }
    assert!(faults.is_empty(), "methods are data, and src/ names them:\n{}", faults.join("\n"));
    // A name that is there is found.
    assert_eq!(named("let a = 1;\n// as Imai2016 does", &words).len(), 2);
}
