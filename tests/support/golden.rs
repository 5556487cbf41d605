//! Comparing text with files that hold what is expected.

#![allow(dead_code, reason = "each test program uses a part of it")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Compares `actual` with the file `path` (from the root of the repository).
///
/// # Panics
/// If the file is missing or differs: the panic shows a diff and how to make the file. With
/// `MENISCUS_BLESS=1` in the environment the file is written instead.
pub fn golden(path: impl AsRef<Path>, actual: &str) {
    if let Err(report) = compare(path.as_ref(), actual) {
        panic!("{report}");
    }
}

/// As [`golden`], for tests that gather the reports of many files.
pub fn compare(path: &Path, actual: &str) -> Result<(), String> {
    let full = root().join(path);
    if std::env::var_os("MENISCUS_BLESS").is_some_and(|v| v == "1") {
        if let Some(folder) = full.parent() {
            std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        }
        return std::fs::write(&full, actual).map_err(|e| format!("{}: {e}", full.display()));
    }
    let remedy = "if this is right, write it with `MENISCUS_BLESS=1 cargo test` and look at the change";
    match std::fs::read_to_string(&full) {
        Ok(expected) if expected.replace("\r\n", "\n") == actual => Ok(()),
        Ok(expected) => Err(format!("{} differs:\n{}{remedy}", path.display(), diff(&expected, actual))),
        Err(error) => Err(format!("{}: {error}\nit would hold:\n{actual}{remedy}", path.display())),
    }
}

/// The root of the repository.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Lines that differ, with what they share around them cut short.
fn diff(expected: &str, actual: &str) -> String {
    let (a, b): (Vec<&str>, Vec<&str>) = (expected.lines().collect(), actual.lines().collect());
    let head = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    let tail = a[head..].iter().rev().zip(b[head..].iter().rev()).take_while(|(x, y)| x == y).count();
    let mut text = String::new();
    for line in &a[head.saturating_sub(3)..head] {
        _ = writeln!(text, "  {line}");
    }
    for line in &a[head..a.len() - tail] {
        _ = writeln!(text, "- {line}");
    }
    for line in &b[head..b.len() - tail] {
        _ = writeln!(text, "+ {line}");
    }
    for line in a[a.len() - tail..].iter().take(3) {
        _ = writeln!(text, "  {line}");
    }
    text
}
