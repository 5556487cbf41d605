//! No text of a graph makes the checker panic or hang.

use std::path::Path;
use std::time::{Duration, Instant};

use meniscus::files::MemoryFiles;

use super::all_said;
use super::cases;
use super::shipped::graphs;
use crate::golden;

/// What any one check may take, in a build that is not optimized and on a busy machine.
const LONGEST: Duration = Duration::from_secs(20);

/// Tokens that take the place of others.
const OTHERS: &[&str] = &[
    "0",
    "1",
    "-1",
    "65536",
    "99999",
    "4294967296",
    "9223372036854775807",
    "0.5",
    "1e300",
    "\"\"",
    "\"viewport\"",
    "\"time\"",
    "\"color\"",
    "\"1 / 0\"",
    "\"-2147483648\"",
    "\"(1, 2, 3)\"",
    "(",
    ")",
    "[",
    "}",
    ",",
    "Texture",
    "Buffer",
    "Counted",
    "D3",
    "Cube",
    "R32Uint",
    "Depth32Float",
    "Auto",
    "true",
    "None",
];

/// Splitmix64: the same mutations in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}

/// Byte ranges of words, numbers, strings and punctuation.
fn tokens(text: &str) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    let mut chars = text.char_indices().peekable();
    while let Some((start, c)) = chars.next() {
        if c.is_whitespace() {
            continue;
        }
        let mut end = start + c.len_utf8();
        let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        while let Some((at, next)) = chars.peek().copied() {
            let goes_on = if c == '"' { next != '"' } else { is_word(c) && is_word(next) };
            if c == '"' && next == '"' {
                end = at + 1;
                chars.next();
                break;
            }
            if !goes_on {
                break;
            }
            end = at + next.len_utf8();
            chars.next();
        }
        out.push((start, end));
    }
    out
}

fn mutate(text: &str, random: &mut Random) -> String {
    let tokens = tokens(text);
    let (a, b) = (tokens[random.below(tokens.len())], tokens[random.below(tokens.len())]);
    match random.below(5) {
        0 => {
            let lines: Vec<&str> = text.lines().collect();
            let gone = random.below(lines.len());
            lines.iter().enumerate().filter(|(i, _)| *i != gone).map(|(_, l)| format!("{l}\n")).collect()
        }
        1 if a.1 <= b.0 => [&text[..a.0], &text[b.0..b.1], &text[a.1..b.0], &text[a.0..a.1], &text[b.1..]].concat(),
        2 => [&text[..a.0], &text[b.0..b.1], &text[a.1..]].concat(),
        _ => [&text[..a.0], OTHERS[random.below(OTHERS.len())], &text[a.1..]].concat(),
    }
}

/// Files under `graphs/` and `shaders/`, as a project in memory.
fn project() -> MemoryFiles {
    let mut files = MemoryFiles::default();
    let mut folders = vec![golden::root().join("graphs"), golden::root().join("shaders")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(golden::root()).unwrap().to_path_buf();
                files = files.with(name, std::fs::read(&path).unwrap());
            }
        }
    }
    files
}

/// After this a file gets no more than [`FEWEST`] mutations: graphs of hundreds of passes take long without optimization.
const ENOUGH: Duration = Duration::from_secs(3);
const FEWEST: usize = 20;

/// Checks mutations of one file until the number is reached.
fn try_mutations(files: &MemoryFiles, changed: &Path, root: &str, count: usize, random: &mut Random) {
    let text = String::from_utf8(files.0[changed].to_vec()).unwrap();
    let began = Instant::now();
    for done in 0..count {
        if done >= FEWEST && began.elapsed() > ENOUGH {
            break;
        }
        let mut mutated = mutate(&text, random);
        if random.below(3) == 0 && !tokens(&mutated).is_empty() {
            mutated = mutate(&mutated, random);
        }
        let with = files.clone().with(changed, &mutated);
        let start = Instant::now();
        let result = std::panic::catch_unwind(|| all_said(&with, root, None));
        assert!(result.is_ok(), "a panic at this {}:\n{mutated}", changed.display());
        assert!(start.elapsed() < LONGEST, "{:?} for this {}:\n{mutated}", start.elapsed(), changed.display());
    }
}

#[test]
fn no_mutation_of_a_shipped_graph_panics_or_hangs() {
    let files = project();
    let mut random = Random(1);
    for path in graphs() {
        let changed = path.strip_prefix(golden::root()).unwrap().to_path_buf();
        try_mutations(&files, &changed, changed.to_str().unwrap(), 150, &mut random);
    }
}

/// The cases are near to mistakes already, and reach more of the rules.
#[test]
fn no_mutation_of_a_case_panics_or_hangs() {
    let mut random = Random(2);
    for case in cases::cases() {
        try_mutations(&case.files, Path::new("graph.ron"), "graph.ron", 20, &mut random);
    }
}
