//! Statistics, from a graph to numbers.

use std::collections::BTreeMap;
use std::path::PathBuf;

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::{Engine, Gpu, GpuOptions};
use meniscus::files::MemoryFiles;
use meniscus::host::{Cache, Content, Job, Moment, Session, load};
use meniscus::plan::stats::Statistic;

/// Eight items, every second of which is appended to a list; the last mass is no number. `aside` is of
/// no use to any output.
const GRAPH: &str = r#"Graph(
    params: { "gain": Float(default: 2.0, min: 0.0, max: 9.0) },
    resources: {
        "parts": Buffer(items: 8), "aside": Buffer(items: 8), "odd": Counted(capacity: 6),
        "color": Texture(format: Rgba16Float, size: "viewport"),
    },
    passes: [
        Clear("odd"),
        Compute(name: "parts", shader: "parts.wgsl", groups: 1),
        Compute(name: "aside", shader: "aside.wgsl", groups: 1),
        Fullscreen(name: "seen", shader: "seen.wgsl", color: ["color"]),
    ],
    outputs: ["color"],
    stats: {
        "mass": "sum(parts.mass)", "gained": "gain * max(parts.mass)", "least": "min(parts.number)",
        "mean": "mean(parts.number)", "third": "parts[3].place.y", "bad": "nans(parts)", "odd": "count(odd)",
        "none": "1 / (count(odd) - 4)", "is_high": "max(parts.number) > 16", "aside": "sum(aside)",
    },
)"#;

const PARTS: &str = "
struct Part { place: vec2f, mass: f32, number: i32 }
struct Odd { count: atomic<u32>, items: array<u32> }
var<storage, read_write> parts: array<Part>;
var<storage, read_write> odd: Odd;
@compute @workgroup_size(8)
fn main(@builtin(local_invocation_index) i: u32) {
    var mass = f32(i) * 0.25;
    if i == 7u { mass = bitcast<f32>(0x7fc00000u + i - 7u); }
    parts[i] = Part(vec2f(f32(i), -f32(i)), mass, 10 - 3 * i32(i));
    if i % 2u == 1u { odd.items[atomicAdd(&odd.count, 1u)] = i; }
}";
const ASIDE: &str = "
var<storage, read_write> aside: array<u32>;
@compute @workgroup_size(8)
fn main(@builtin(local_invocation_index) i: u32) { aside[i] = 0x80000000u + i; }";
const SEEN: &str = "
struct Part { place: vec2f, mass: f32, number: i32 }
struct Odd { count: u32, items: array<u32> }
var<storage> parts: array<Part>;
var<storage> odd: Odd;
@fragment
fn main() -> @location(0) vec4f { return vec4f(parts[0].mass + f32(odd.count)); }";

fn session(stats: bool) -> Session {
    let scene = r#"Scene(graph: "graph.ron", camera: Camera(eye: (0, 0, 3), target: (0, 0, 0)), size: (8, 8))"#;
    let files = MemoryFiles::default()
        .with("parts.wgsl", PARTS)
        .with("aside.wgsl", ASIDE)
        .with("seen.wgsl", SEEN)
        .with("graph.ron", GRAPH)
        .with("scene.ron", scene);
    let mut sources = Sources::new();
    let job = Job { source: PathBuf::from("scene.ron"), stats, ..Job::default() };
    let loaded = load(&files, &mut sources, &job, &mut Cache::default());
    let said = render_all(&loaded.diagnostics, &sources, Style::Plain);
    let mut session = Session::new(Gpu::open(&GpuOptions::default()).unwrap());
    session.build(loaded.content.unwrap_or_else(|| panic!("{said}"))).unwrap();
    session
}

fn by_name(found: Vec<Statistic>) -> BTreeMap<String, Option<f64>> {
    found.into_iter().map(|statistic| (statistic.path, statistic.value)).collect()
}

pub fn statistics_are_what_buffers_hold(_: &mut Engine) {
    let mut session = session(true);
    session.draw(Moment::default(), false).unwrap();
    let found = by_name(session.statistics().unwrap());
    assert!(found["mass"].is_some_and(f64::is_nan), "{found:?}");
    // 0 to 6 quarters count, for the seventh is no number.
    assert_eq!(found["gained"], Some(3.0));
    assert_eq!((found["least"], found["mean"]), (Some(-11.0), Some(-0.5)));
    assert_eq!((found["third"], found["bad"], found["odd"]), (Some(-3.0), Some(1.0), Some(4.0)));
    assert_eq!((found["none"], found["is_high"]), (None, Some(0.0)));
    assert_eq!(found["aside"], Some(8.0 * 2_147_483_648.0 + 28.0));
    // The same without waiting, and once.
    session.ask_statistics().unwrap();
    let polled = std::iter::repeat_with(|| session.poll_statistics()).take(1_000_000).find_map(|found| found);
    let polled = by_name(polled.expect("they never came"));
    assert!(polled.iter().all(|(name, value)| name == "mass" || *value == found[name]), "{polled:?}");
    assert_eq!(session.poll_statistics(), None);
}

pub fn what_only_statistics_need_runs_when_they_are_asked_for(_: &mut Engine) {
    let paths = |session: &Session| -> Vec<String> {
        session.plan().unwrap().passes.iter().map(|pass| pass.path.clone()).filter(|path| path == "aside").collect()
    };
    let mut session = session(false);
    assert!(paths(&session).is_empty());
    session.draw(Moment::default(), false).unwrap();
    let before = session.light().unwrap().rgba;
    let content = session.content().unwrap().clone();
    session.build(Content { stats: true, ..content }).unwrap();
    assert_eq!(paths(&session), ["aside"]);
    session.draw(Moment::default(), false).unwrap();
    assert_eq!(session.light().unwrap().rgba, before, "asking changes no picture");
    assert_eq!(by_name(session.statistics().unwrap())["odd"], Some(4.0));
}
