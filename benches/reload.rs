//! From the end of a save to the new picture: `cargo bench --bench reload`.
//!
//! 200 edits of one shader of a shipped graph at 640 x 480, followed as `watch` does. The waiting for
//! a burst of saves to end is part of it. Needs a device.

#![allow(clippy::unwrap_used, reason = "a bench fails by panicking")]

#[path = "../tests/support/follower.rs"]
mod follower;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use follower::{Follower, Outcome, Times};

const EDITS: usize = 200;
const SCENE: &str = "scenes/dam_break.ron";
const SHADER: &str = "shaders/imai2016/refract.wgsl";

fn main() {
    let folder = std::env::temp_dir().join(format!("meniscus-bench-{}", std::process::id()));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for part in ["graphs", "shaders", "scenes"] {
        copy(&root.join(part), &folder.join(part));
    }
    let mut follower = Follower::new(folder.join(SCENE), [640, 480]);
    let Outcome::Drawn { .. } = follower.reload() else { panic!("the scene does not draw") };
    let shader = folder.join(SHADER);
    let text = std::fs::read_to_string(&shader).unwrap();
    let mut all = Vec::new();
    let mut waits = Vec::new();
    for edit in 0..EDITS {
        // A constant that no picture shows: the module is another one each time.
        std::fs::write(&shader, format!("{text}\nconst EDIT = {edit}u;\n")).unwrap();
        let saved = Instant::now();
        let Outcome::Drawn { times, pipelines_built, .. } = follower.follow() else { panic!("refused") };
        assert_eq!(pipelines_built, 1, "one shader is one pipeline");
        all.push(times);
        waits.push(saved.elapsed());
    }
    print(&all, &waits);
    _ = std::fs::remove_dir_all(folder);
}

fn print(all: &[Times], waits: &[Duration]) {
    let row = |what: &str, pick: &dyn Fn(&Times) -> Duration| {
        let [p50, p99] = percentiles(all.iter().map(pick).collect());
        println!("{what:<28} {p50:>9.1} {p99:>9.1}");
    };
    println!("{:<28} {:>9} {:>9}", format!("ms, over {EDITS} edits"), "p50", "p99");
    row("noticing", &|t| t.noticing);
    row("checking", &|t| t.checking);
    row("building", &|t| t.building);
    row("drawing", &|t| t.drawing);
    row("all but drawing", &|t| t.noticing + t.checking + t.building);
    let [p50, p99] = percentiles(waits.to_vec());
    println!("{:<28} {p50:>9.1} {p99:>9.1}", "from save to picture");
}

fn percentiles(mut times: Vec<Duration>) -> [f64; 2] {
    times.sort();
    [0.5, 0.99].map(|share| times[((times.len() - 1) as f64 * share).round() as usize].as_secs_f64() * 1e3)
}

fn copy(from: &PathBuf, to: &PathBuf) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        match path.is_dir() {
            true => copy(&path, &target),
            false => _ = std::fs::copy(&path, &target).unwrap(),
        }
    }
}
