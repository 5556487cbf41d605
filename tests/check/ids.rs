//! Ids, their sections in `docs/diagnostics.md`, and the goldens that show them.

use std::collections::BTreeSet;
use std::path::Path;

use meniscus::diagnostic::{Code, explain, explained};

use crate::golden;

#[test]
fn every_id_has_a_section() {
    for code in Code::ALL {
        let section = explain(code.as_str());
        assert!(section.is_some_and(|s| s.len() > 80), "docs/diagnostics.md says nothing of `{}`", code.as_str());
    }
}

#[test]
fn every_section_is_of_an_id() {
    let known: Vec<&str> = Code::ALL.iter().map(|code| code.as_str()).collect();
    let mut seen = BTreeSet::new();
    for id in explained() {
        assert!(known.contains(&id), "docs/diagnostics.md explains `{id}`, which is no id");
        assert!(seen.insert(id), "docs/diagnostics.md explains `{id}` twice");
    }
}

#[test]
fn sections_stand_in_the_order_of_the_ids() {
    let sections: Vec<&str> = explained().collect();
    let ids: Vec<&str> = Code::ALL.iter().map(|code| code.as_str()).collect();
    assert_eq!(sections, ids);
}

#[test]
fn every_id_is_shown_by_a_golden() {
    let mut shown = String::new();
    gather(&golden::root().join("tests"), &mut shown);
    for code in Code::ALL {
        let id = code.as_str();
        let is_shown = shown.contains(&format!("[{id}]"));
        assert!(is_shown, "no golden under tests/ shows `{id}`");
    }
}

/// All text of files that hold what is expected.
fn gather(folder: &Path, shown: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_golden = path.extension().is_some_and(|e| e == "txt" || e == "golden");
        if path.is_dir() {
            gather(&path, shown);
        } else if is_golden {
            shown.push_str(&std::fs::read_to_string(&path).unwrap());
        }
    }
}
