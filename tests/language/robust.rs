//! Whatever bytes come: diagnostics, never a panic, in bounded time.

use std::path::Path;

use meniscus::diagnostic::{Severity, Sources, Style, render_all};
use meniscus::{graph, syntax};

use crate::language::cases::graphs;

/// Reads bytes as a graph and renders what is said, which walks every span.
fn digest(bytes: &[u8]) -> usize {
    let mut sources = Sources::new();
    let diagnostics = match syntax::add_bytes(&mut sources, Path::new("g.ron"), bytes) {
        Ok(file) => {
            let (graph, diagnostics) = graph::read(&sources, file, Path::new("g.ron"));
            assert!(graph.is_some() || diagnostics.has_errors(), "nothing read and nothing said");
            diagnostics
        }
        Err(diagnostic) => diagnostic.into(),
    };
    for diagnostic in diagnostics.iter() {
        assert!(!diagnostic.labels.is_empty(), "a diagnostic without a place: {}", diagnostic.message);
        for label in &diagnostic.labels {
            let text = sources.text(label.span.file);
            assert!(text.get(label.span.start as usize..label.span.end as usize).is_some(), "{diagnostic:?}");
        }
    }
    render_all(&diagnostics, &sources, Style::Plain);
    diagnostics.count(Severity::Error)
}

#[test]
fn every_truncation_is_told_and_none_panics() {
    for path in graphs("valid") {
        let bytes = std::fs::read(&path).unwrap();
        let end = bytes.iter().rposition(|b| *b == b')').unwrap();
        for length in 0..=end {
            assert!(digest(&bytes[..length]) > 0, "{} cut at {length} reads", path.display());
        }
        assert_eq!(digest(&bytes), 0);
    }
}

/// A truncated file is one mistake, and is told as few.
#[test]
fn a_truncation_is_no_cascade() {
    for path in graphs("valid") {
        let bytes = std::fs::read(&path).unwrap();
        let end = bytes.iter().rposition(|b| *b == b')').unwrap();
        let mut most = (0, 0);
        for length in 1..end {
            most = most.max((digest(&bytes[..length]), length));
        }
        // The brackets that are open, and the fields that are cut off with them.
        assert!(most.0 <= 12, "{} cut at {} gives {} errors", path.display(), most.1, most.0);
    }
}

#[test]
fn single_byte_mutations_never_panic() {
    // A linear congruential generator: the same mutations every time.
    let mut state = 0x2545_f491_4f6c_dd1du64;
    let mut next = |limit: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % limit
    };
    for path in graphs("valid") {
        let original = std::fs::read(&path).unwrap();
        for round in 0..3000 {
            let mut bytes = original.clone();
            let at = next(bytes.len());
            match round % 3 {
                0 => bytes[at] = b"()[]{}\",:'\\/*#.-+e0 \n"[next(21)],
                1 => bytes[at] = next(256) as u8,
                _ => _ = bytes.remove(at),
            }
            digest(&bytes);
        }
    }
}

/// One bracket more or less in a laid-out file is one syntax error, or two where indentation
/// does not help.
#[test]
fn a_lost_bracket_is_one_mistake() {
    let mut told = Vec::new();
    for path in graphs("valid") {
        let text = std::fs::read_to_string(&path).unwrap();
        let brackets = text.char_indices().filter(|(_, c)| "()[]{}".contains(*c));
        for (at, c) in brackets {
            // Brackets of expressions stand in strings, of remarks in comments.
            let line = text[..at].lines().next_back().unwrap_or_default();
            if line.matches('"').count() % 2 == 1 || line.contains("//") {
                continue;
            }
            let cut = format!("{} {}", &text[..at], &text[at + 1..]);
            told.push((digest(cut.as_bytes()), format!("{} without {c} at {at}", path.display())));
        }
    }
    let (single, few, all) =
        (told.iter().filter(|(n, _)| *n == 1).count(), told.iter().filter(|(n, _)| *n <= 3).count(), told.len());
    let worst = told.iter().max().unwrap();
    eprintln!("{single} of {all} lost brackets are one error, {few} at most three; worst {worst:?}");
    for (n, what) in told.iter().filter(|(n, _)| *n > 1) {
        eprintln!("{n}: {what}");
    }
    assert!(told.iter().all(|(n, _)| *n > 0));
    assert!(single * 100 >= all * 90, "only {single} of {all} lost brackets give one error");
    assert!(few * 100 >= all * 95, "only {few} of {all} lost brackets give at most three errors");
}

#[test]
fn hostile_texts_take_bounded_time() {
    let started = std::time::Instant::now();
    for text in [
        "(".repeat(200_000),
        ")".repeat(200_000),
        "([{".repeat(50_000),
        "(]".repeat(50_000),
        "\"a\n".repeat(50_001),
        "/*".repeat(100_000),
        format!("Graph(let: {{\"a\": \"{}1\"}}, passes: [], outputs: [])", "(".repeat(100_000)),
        format!("Graph(let: {{\"a\": \"{}1\"}}, passes: [], outputs: [])", "1+".repeat(100_000)),
        format!("Graph(let: {{\"a\": \"{}1\"}}, passes: [], outputs: [])", "-".repeat(100_000)),
        format!("Graph(let: {{\"a\": \"{}1\"}}, passes: [], outputs: [])", "not ".repeat(100_000)),
        format!("Graph({})", (0..50_000).map(|i| format!("f{i}: 1,\n")).collect::<Vec<_>>().concat()),
        format!("[{}]", "a b ".repeat(20_000)),
    ] {
        let begun = std::time::Instant::now();
        assert!(digest(text.as_bytes()) > 0);
        eprintln!("{:?} for {}", begun.elapsed(), text.get(..24).unwrap_or_default().escape_debug());
    }
    let took = started.elapsed();
    assert!(took.as_secs() < 60, "{took:?}");
}
