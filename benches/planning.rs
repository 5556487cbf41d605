//! How long planning takes, and how it grows: `cargo bench --bench planning`.
//!
//! Graphs of n passes over 2 n resources, n from 250 to 10,000, in four shapes. Loading files and
//! reading shaders is not counted: at run time that is done once, and planning for each change of
//! a size, a count or a parameter.

#![allow(clippy::unwrap_used, reason = "a bench fails by panicking")]

use std::fmt::Write as _;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::files::MemoryFiles;
use meniscus::plan::instantiate;
use meniscus::plan::model::{InputInfo, Plan, Request};
use meniscus::program::{self, Program};
use wgpu_types::{Features, Limits};

/// Reads one buffer and writes two, with a parameter and the camera.
const PAIR: &str = "struct Values { gain: f32, sigma: f32 } var<uniform> values: Values;
    struct Eye { position: vec3<f32> } var<uniform> camera: Eye;
    var<storage, read> src: array<f32>; var<storage, read_write> left: array<f32>; var<storage, read_write> right: array<f32>;
    @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
        left[i.x] = src[i.x] * values.gain; right[i.x] = values.sigma + camera.position.x; }";
const FILL: &str = "var<storage, read_write> dst: array<f32>;
    @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) { dst[i.x] = 1.0; }";
const FILTER: &str = "var src: texture_2d<f32>;
    @fragment fn main(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32> { return textureLoad(src, vec2<i32>(p.xy), 0); }";

const HEAD: &str = r#"Graph(
    inputs: { "camera": Camera },
    params: { "gain": Float(default: 1.0, min: 0.0, max: 9.0), "sigma": Float(default: 2.0, min: 0.0, max: 9.0), "size": Int(default: 100, min: 1, max: 1000) },
"#;

fn pair(text: &mut String, name: usize, src: usize, left: usize) {
    let right = left + 1;
    _ = writeln!(
        text,
        r#"Compute(name: "p{name}", shader: "pair.wgsl", each: Item("b{left}"), bind: {{"src": "b{src}", "left": "b{left}", "right": "b{right}"}}),"#
    );
}

fn buffers(count: usize) -> String {
    (0..count).map(|i| format!("\"b{i}\": Buffer(items: \"size + {}\"),\n", i % 7)).collect()
}

fn filled(passes: &str, count: usize, output: usize) -> String {
    let first = r#"Compute(name: "first", shader: "fill.wgsl", each: Item("b0"), bind: {"dst": "b0"}),"#;
    format!("{HEAD} resources: {{ {} }}, passes: [ {first}\n{passes} ], outputs: [\"b{output}\"] )", buffers(count))
}

/// Each pass reads what the one before wrote.
fn chain(n: usize) -> String {
    let mut passes = String::new();
    (1..n).for_each(|p| pair(&mut passes, p, 2 * p - 2, 2 * p));
    filled(&passes, 2 * n, 2 * n - 2)
}

/// All read the same, and many live at once.
fn fan(n: usize) -> String {
    let mut passes = String::new();
    (1..n).for_each(|p| pair(&mut passes, p, if p + 1 == n { 2 } else { 2 * (p / 8) }, 2 * p));
    let outputs: String = (1..n).map(|p| format!("\"b{}\",", 2 * p)).collect();
    filled(&passes, 2 * n, 2 * n - 2)
        .replace(&format!("outputs: [\"b{}\"]", 2 * n - 2), &format!("outputs: [{outputs}]"))
}

/// Nothing needs most of it.
fn culled(n: usize) -> String {
    let mut passes = String::new();
    (1..n).for_each(|p| pair(&mut passes, p, 0, 2 * p));
    filled(&passes, 2 * n, 2)
}

/// One loop over two textures that swap, beside many resources.
fn unrolled(n: usize) -> String {
    let textures: String =
        ["t", "u"].map(|name| format!("\"{name}\": Texture(format: Rgba16Float, size: (64, 64)),\n")).concat();
    let passes = format!(
        r#"Clear(name: "zero", of: "t"), Repeat(times: {}, swap: [("t", "u")], passes: [
        Fullscreen(name: "turn", shader: "filter.wgsl", color: ["u"], bind: {{"src": "t"}}) ]),"#,
        // All loops together may make 10,000 passes, and iterations count as they do.
        (n - n / 10) / 2
    );
    format!("{HEAD} resources: {{ {textures} {} }}, passes: [ {passes} ], outputs: [\"t\"] )", buffers(2 * n))
}

fn load(graph: &str) -> Program {
    let files = MemoryFiles::default()
        .with("graphs/bench.ron", graph)
        .with("shaders/pair.wgsl", PAIR)
        .with("shaders/fill.wgsl", FILL)
        .with("shaders/filter.wgsl", FILTER);
    let mut sources = Sources::new();
    let loaded = program::load(&files, &mut sources, "graphs/bench.ron", None);
    loaded.program.unwrap_or_else(|| panic!("{}", render_all(&loaded.diagnostics, &sources, Style::Plain)))
}

fn request(roots: Vec<String>) -> Request {
    Request {
        viewport: [640, 480],
        params: Default::default(),
        inputs: [("camera".to_owned(), InputInfo::Camera)].into(),
        capacities: Default::default(),
        roots,
        stats: false,
        memory: Default::default(),
        features: Features::all(),
        limits: Limits::default(),
    }
}

/// How long this thread was on a processor, where the system tells: other programs do not count.
fn on_processor() -> Option<Duration> {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    told.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

/// The shortest of some runs, the mean time of them on a processor, and the plan.
fn time(program: &Program, request: &Request) -> (Duration, Option<Duration>, Plan) {
    let mut best: Option<(Duration, Plan)> = None;
    let (began, before) = (Instant::now(), on_processor());
    let mut runs = 0;
    while best.is_none() || began.elapsed() < Duration::from_millis(400) {
        let start = Instant::now();
        let plan = instantiate(program, request).unwrap_or_else(|found| panic!("{:?}", found.iter().next()));
        let took = start.elapsed();
        runs += 1;
        if best.as_ref().is_none_or(|(least, _)| took < *least) {
            best = Some((took, plan));
        }
    }
    let spent = on_processor().zip(before).map(|(after, before)| (after - before) / runs);
    let (took, plan) = best.unwrap();
    (took, spent, plan)
}

/// Milliseconds of the processor that a plan of 1,000 passes and 2,000 resources may take.
const MOST_MS: f64 = 20.0;
/// How much longer one of ten times the passes may take.
const MOST_GROWTH: f64 = 25.0;

fn main() -> ExitCode {
    let mut is_within = true;
    // `cargo test --benches` only asks whether it runs.
    let sizes: &[usize] = if std::env::args().any(|a| a == "--bench") { &[250, 1000, 4000, 10_000] } else { &[50] };
    println!("{:<9} {:>7} {:>10} {:>7} {:>10} {:>10}", "shape", "passes", "resources", "live", "ms", "CPU ms");
    type Shape = (&'static str, fn(usize) -> String);
    let shapes: [Shape; 4] = [("chain", chain), ("fan", fan), ("culled", culled), ("unrolled", unrolled)];
    // `cargo bench --bench planning -- fan` measures one shape alone.
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    for (name, graph) in shapes.into_iter().filter(|(name, _)| chosen.is_empty() || chosen.iter().any(|c| c == name)) {
        let mut of_thousand_ms = None;
        for n in sizes.iter().copied() {
            let program = load(&graph(n));
            let outputs = program.root.outputs.iter().map(|output| output.name.value.clone()).collect();
            let (took, spent, plan) = time(&program, &request(outputs));
            let (ms, live) = (took.as_secs_f64() * 1e3, plan.passes.len());
            let cpu = spent.map_or_else(|| "-".to_owned(), |spent| format!("{:.2}", spent.as_secs_f64() * 1e3));
            println!("{name:<9} {n:>7} {:>10} {live:>7} {ms:>10.2} {cpu:>10}", 2 * n);
            let spent_ms = spent.map_or(ms, |spent| spent.as_secs_f64() * 1e3);
            match (n, of_thousand_ms) {
                (1000, _) => {
                    of_thousand_ms = Some(spent_ms);
                    is_within &= spent_ms <= MOST_MS;
                }
                (10_000, Some(thousand_ms)) => {
                    println!("{:<9} ten times the passes take {:.1} times as long", "", spent_ms / thousand_ms);
                    is_within &= spent_ms / thousand_ms <= MOST_GROWTH;
                }
                _ => {}
            }
        }
    }
    if is_within {
        return ExitCode::SUCCESS;
    }
    eprintln!("a plan takes longer than {MOST_MS} ms for 1,000 passes, or {MOST_GROWTH} times that for 10,000");
    ExitCode::FAILURE
}
