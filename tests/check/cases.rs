//! Each `cases/NAME.case` is a program with mistakes, and `cases/NAME.txt` the whole text that is
//! said about it.
//!
//! A case begins with a line that says what it shows. Where its mistakes are several, the next
//! line is `several`; else one message is all that may come. Then follow files, each after a
//! line `=== PATH`; `graph.ron` is the one that is checked. Files of `shared/` stand under
//! `shaders/` of every case.

use std::path::PathBuf;

use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::files::MemoryFiles;

use super::all_said;
use crate::golden;

pub struct Case {
    pub name: String,
    pub several: bool,
    pub files: MemoryFiles,
}

/// Every wrong program, sorted by name.
pub fn cases() -> Vec<Case> {
    let cases = read("cases");
    assert!(cases.len() > 100, "the cases are not there");
    cases
}

fn read(folder: &str) -> Vec<Case> {
    let folder = golden::root().join("tests/check").join(folder);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "case"));
    paths.sort();
    paths.iter().map(|path| case(path.file_stem().unwrap().to_str().unwrap(), &text(path))).collect()
}

fn text(path: &PathBuf) -> String {
    std::fs::read_to_string(path).unwrap().replace("\r\n", "\n")
}

fn case(name: &str, text: &str) -> Case {
    let mut parts = text.split("\n=== ");
    let head = parts.next().unwrap();
    assert!(!head.trim().is_empty(), "{name}: the first line says what the case shows");
    let several = head.lines().nth(1).is_some_and(|line| line == "several");
    let mut files = shared();
    for part in parts {
        let (path, text) = part.split_once('\n').unwrap();
        files = files.with(path.trim(), format!("{}\n", text.trim_end()));
    }
    Case { name: name.to_owned(), several, files }
}

/// The shaders that cases share.
pub fn shared() -> MemoryFiles {
    let mut files = MemoryFiles::default();
    for entry in std::fs::read_dir(golden::root().join("tests/check/shared")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        files = files.with(format!("shaders/{name}"), text(&path));
    }
    files
}

fn said(case: &Case) -> (Diagnostics, Sources) {
    all_said(&case.files, "graph.ron", None)
}

#[test]
fn every_mistake_is_told_as_its_golden_says() {
    let mut reports = Vec::new();
    for case in cases() {
        let (diagnostics, sources) = said(&case);
        let text = render_all(&diagnostics, &sources, Style::Plain);
        let expected = format!("tests/check/cases/{}.txt", case.name);
        reports.extend(golden::compare(expected.as_ref(), &text).err());
    }
    assert!(reports.is_empty(), "{}", reports.join("\n\n"));
}

/// What is near to a mistake and is none: `valid/NAME.case`.
#[test]
fn nothing_is_said_about_right_programs() {
    let cases = read("valid");
    assert!(cases.len() > 8, "the valid programs are not there");
    let mut reports = Vec::new();
    for case in cases {
        let (diagnostics, sources) = said(&case);
        if !diagnostics.is_empty() {
            reports.push(format!("{}:\n{}", case.name, render_all(&diagnostics, &sources, Style::Plain)));
        }
    }
    assert!(reports.is_empty(), "{}", reports.join("\n"));
}

/// A shader and a graph that do not fit are both shown.
#[test]
fn what_does_not_fit_is_shown_in_graph_and_shader() {
    let of_both = ["binding-mismatch", "uniform-mismatch", "unbound", "layout-disagreement", "folded-dispatch"];
    for case in cases() {
        let (diagnostics, sources) = said(&case);
        for diagnostic in diagnostics.iter().filter(|d| of_both.contains(&d.id.as_str())) {
            for ending in [".ron", ".wgsl"] {
                let is_shown = diagnostic.labels.iter().any(|label| sources.path(label.span.file).ends_with(ending));
                assert!(is_shown, "{}: no {ending} file beside \"{}\"", case.name, diagnostic.message);
            }
        }
    }
}

/// Neither silence nor a cascade.
#[test]
fn one_mistake_gives_one_message() {
    let mut wrong = Vec::new();
    for case in cases() {
        let count = said(&case).0.iter().count();
        if count == 0 || (count > 1) != case.several {
            wrong.push(format!("{}: {count} messages", case.name));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A person can see from every message where to look.
#[test]
fn every_message_has_a_place() {
    for case in cases() {
        for diagnostic in said(&case).0.iter() {
            assert!(!diagnostic.labels.is_empty(), "{}: {}", case.name, diagnostic.message);
            let first = diagnostic.message.chars().next().unwrap();
            assert!(!first.is_uppercase(), "{}: {}", case.name, diagnostic.message);
        }
    }
}
