//! What a graph costs against the same frame written by hand with wgpu, side by side in one
//! process: `cargo bench --bench by_hand`.
//!
//! Both sides have the same shader modules, sizes and order of passes, record the same frame
//! with a new camera, and wait for the GPU before the next, so that neither hides behind it. The
//! sides take turns frame by frame, in an order that alternates. Nothing is skipped and nothing
//! is timed on the GPU. The pictures must be equal to the byte.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a bench fails by panicking, and prints")]

mod cases;
mod hand;

use std::time::Instant;

use cases::Case;
use hand::{Hand, Way};
use meniscus::engine::{Engine, Frame, Gpu, GpuOptions};
use meniscus::plan::model::{ObjectKind, ObjectRef};

/// What one frame took, in milliseconds.
#[derive(Clone, Copy, Default)]
struct Took {
    encode: f64,
    submit: f64,
    /// From submission until the GPU was done.
    gpu: f64,
}

const SIDES: [&str; 3] = ["by hand", "by hand, merged", "graph"];
/// The most that the graph may take of what a hand-written frame takes to encode.
const BOUND: f64 = 1.05;

fn main() {
    // `cargo test --benches` only asks whether it runs.
    let is_bench = std::env::args().any(|a| a == "--bench");
    let part = if is_bench { 1 } else { 100 };
    let gpu = match Gpu::open(&GpuOptions::default()) {
        Ok(gpu) => gpu,
        Err(lacking) => {
            println!("not run: {}", lacking.message);
            return;
        }
    };
    println!("{}; milliseconds, the median\n", gpu.info().name);
    let mut engine = Engine::new(gpu);
    let mut is_within = true;
    for case in [cases::chain(), cases::shipped("imai2016.ron", [96, 72]), cases::shipped("imai2016.ron", [640, 480])] {
        let took = run(&mut engine, &case, case.frames.div_ceil(part));
        is_within &= report(&case, &took);
    }
    assert!(is_within || !is_bench, "the graph takes more than {BOUND} of the hand-written frame to encode");
}

/// Frames of all sides in turn, and the comparison of what they drew.
fn run(engine: &mut Engine, case: &Case, frames: usize) -> [Vec<Took>; 3] {
    let plan = case.plan(engine);
    let hand = Hand::new(engine.gpu().device(), engine.gpu().queue(), &plan, &case.positions);
    let mut runner = engine.prepare(plan.clone(), None).unwrap_or_else(|refused| panic!("{:?}", refused.diagnostics));
    case.upload(engine, &mut runner);
    runner.time_passes(false);
    runner.run_all(true);
    let mut took: [Vec<Took>; 3] = Default::default();
    let warm_up = 3;
    for nth in 0..frames + warm_up {
        let values = cases::live(nth);
        let live = |name: &str| values.get(name).cloned();
        let bytes = hand::uniforms(&plan, &|name| if name == "time" { Some(cases::time(nth)) } else { live(name) });
        for turn in 0..3 {
            let side = (turn + nth) % 3;
            let gpu = engine.gpu();
            let mut encode;
            let mut submit = 0.0;
            if side == 2 {
                let time = cases::seconds(nth);
                let frame =
                    Frame { time, delta: 0.0, frame: nth as u64, steps: &[], live: &|name, _| live(name), only: None };
                let began = Instant::now();
                runner.advance(engine, &frame).unwrap_or_else(|d| panic!("{d:?}"));
                encode = began.elapsed().as_secs_f64() * 1e3;
            } else {
                let way = if side == 0 { Way::Plain } else { Way::Careful };
                let took = hand.frame(gpu.device(), gpu.queue(), &bytes, way);
                (encode, submit) = (took.encode_ms, took.submit_ms);
            }
            let began = Instant::now();
            engine.gpu().wait().unwrap();
            let waited = began.elapsed().as_secs_f64() * 1e3;
            if side == 2 {
                submit = runner.poll(engine).expect("the frame is done").submit_ms;
                encode -= submit;
            }
            if nth >= warm_up {
                took[side].push(Took { encode, submit, gpu: submit + waited });
            }
        }
        if nth == 0 || nth + 1 == frames + warm_up {
            compare(engine, &runner, &hand);
        }
    }
    took
}

/// Every output, to the byte.
fn compare(engine: &mut Engine, runner: &meniscus::engine::Runner, hand: &Hand) {
    for (nth, output) in runner.plan().outputs.clone().into_iter().enumerate() {
        let ObjectRef::Fixed(id) = output.object else { continue };
        let (graph, by_hand) = match &runner.plan().objects[id].kind {
            ObjectKind::Texture(_) => {
                let read = runner.read_texture(engine, output.object, 0, None).unwrap();
                (read.bytes, cases::read_texture(engine.gpu(), hand.texture(id)))
            }
            ObjectKind::Buffer(_) => {
                let read = runner.read_buffer(engine, output.object).unwrap();
                (read, cases::read_buffer(engine.gpu(), hand.buffer(id)))
            }
        };
        // Others may hold nothing in this view, the first is the picture.
        assert!(nth > 0 || graph.iter().any(|byte| *byte != 0), "`{}` is empty", output.name);
        assert!(graph == by_hand, "`{}` is not what the hand-written frame makes", output.name);
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Prints a case; whether the graph keeps to the bound.
fn report(case: &Case, took: &[Vec<Took>; 3]) -> bool {
    println!("{}, {} frames a side", case.name, took[0].len());
    println!("  {:<16} {:>8} {:>8} {:>8}   encode of the graph to this, with 95 %", "", "encode", "submit", "gpu");
    let mut is_within = true;
    for (side, frames) in SIDES.iter().zip(took) {
        let of = |part: fn(&Took) -> f64| median(frames.iter().map(part).collect());
        // Frame by frame, since what else runs on the machine changes slowly.
        let pairs: Vec<f64> = took[2].iter().zip(frames).map(|(graph, other)| graph.encode / other.encode).collect();
        let (low, middle, high) = interval(&pairs);
        let (encode, submit, gpu) = (of(|t| t.encode), of(|t| t.submit), of(|t| t.gpu));
        let ratio = if *side == "graph" { String::new() } else { format!("{middle:.3} ({low:.3} to {high:.3})") };
        println!("  {side:<16} {encode:>8.4} {submit:>8.4} {gpu:>8.3}   {ratio}");
        if *side == "by hand" {
            is_within = middle <= BOUND;
        }
    }
    println!();
    is_within
}

/// The median with the bounds that hold it with a chance of 95 % (order statistics).
fn interval(values: &[f64]) -> (f64, f64, f64) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let half = 0.98 * n.sqrt();
    let at = |place: f64| sorted[(place.max(0.0) as usize).min(sorted.len() - 1)];
    (at(n / 2.0 - half), at(n / 2.0), at(n / 2.0 + half))
}
