//! How long loading and checking each shipped graph takes: `cargo bench --bench checking`.
//!
//! The checker is asked at every save, so it should answer before a person has looked up: under 50 ms.

#![allow(clippy::unwrap_used, reason = "a bench that cannot read its graphs has nothing to say")]

use std::path::Path;
use std::time::Instant;

use meniscus::diagnostic::Sources;
use meniscus::files::DiskFiles;
use meniscus::{check, program};

/// Runs of each graph; the fastest and the middle one are shown.
const RUNS: usize = 11;

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    println!("{:>10} {:>10}  graph, load and check in ms", "fastest", "median");
    for folder in ["graphs", "graphs/parts"] {
        let mut paths: Vec<_> = std::fs::read_dir(root.join(folder)).unwrap().map(|e| e.unwrap().path()).collect();
        paths.retain(|path| path.extension().is_some_and(|end| end == "ron"));
        paths.sort();
        for path in paths {
            let mut times: Vec<f64> = (0..RUNS).map(|_| once(path.to_str().unwrap())).collect();
            times.sort_by(f64::total_cmp);
            let name = path.strip_prefix(root).unwrap_or(&path).display();
            println!("{:>10.2} {:>10.2}  {name}", times[0], times[RUNS / 2]);
        }
    }
}

/// Milliseconds from nothing read to everything said.
fn once(path: &str) -> f64 {
    let start = Instant::now();
    let loaded = program::load(&DiskFiles, &mut Sources::new(), path, None);
    let program = loaded.program.expect("shipped graphs load");
    assert!(!check::check(&program).has_errors(), "{path} has errors");
    start.elapsed().as_secs_f64() * 1e3
}
