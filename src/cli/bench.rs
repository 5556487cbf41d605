//! `meniscus bench`: the time of each pass on the GPU, of encoding on the CPU, and memory.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::json;

use super::args::{BenchArgs, BenchFormat};
use super::report::{Exit, print, report};
use super::session::{Opening, job};
use crate::diagnostic::{Diagnostics, Sources};
use crate::files::DiskFiles;
use crate::host::{Cache, Moment, Session, load};
use crate::plan::print::bytes;

/// Frames before the first that counts: drivers compile late.
const WARM_UP: u32 = 2;

pub fn run(args: &BenchArgs) -> Exit {
    let mut sources = Sources::new();
    match bench(args, &mut sources) {
        Ok((measured, notes)) => {
            report(&notes, &sources);
            print(&match args.format {
                BenchFormat::Table => table(&measured),
                BenchFormat::Json => format!("{:#}\n", as_json(&measured)),
                BenchFormat::Csv => csv(&measured),
            })
        }
        Err(found) => report(&found, &sources),
    }
}

/// What was measured.
#[derive(Debug, Default)]
struct Measured {
    adapter: String,
    frames: u32,
    /// Milliseconds on the GPU of each frame, by pass, in the order of the first frame.
    passes: Vec<(String, Vec<f64>)>,
    gpu_ms: Vec<f64>,
    encode_ms: Vec<f64>,
    memory_bytes: u64,
    unshared_bytes: u64,
    lower_bound_bytes: u64,
}

fn bench(args: &BenchArgs, sources: &mut Sources) -> Result<(Measured, Diagnostics), Diagnostics> {
    let opening = Opening::begin(args.scene.backend.as_deref());
    let loaded = load(&DiskFiles, sources, &job(&args.scene), &mut Cache::default());
    let mut notes = loaded.diagnostics;
    let Some(content) = loaded.content else { return Err(notes) };
    let mut session = Session::new(opening.wait()?);
    let built = session.build(content)?;
    session.run_all(true);
    notes.extend(built.diagnostics);
    let mut measured = Measured { frames: args.frames, ..Measured::default() };
    let mut index = BTreeMap::new();
    for frame in 0..WARM_UP + args.frames {
        let drawn = session.draw(Moment::default(), true)?;
        notes.extend(drawn.diagnostics);
        if frame < WARM_UP {
            continue;
        }
        measured.encode_ms.push(drawn.reports.iter().map(|r| r.encode_ms).sum());
        let total: Option<f64> = drawn.reports.iter().map(|r| r.gpu_ms()).sum();
        measured.gpu_ms.extend(total);
        for pass in drawn.reports.iter().flat_map(|r| &r.passes) {
            let at = *index.entry(pass.path.clone()).or_insert_with(|| {
                measured.passes.push((pass.path.clone(), Vec::new()));
                measured.passes.len() - 1
            });
            measured.passes[at].1.extend(pass.gpu_ms);
        }
    }
    measured.adapter = session.gpu().info().name;
    measured.memory_bytes = built.memory_bytes;
    if let Some(plan) = session.plan() {
        measured.unshared_bytes = plan.memory.unshared;
        measured.lower_bound_bytes = plan.memory.lower_bound;
    }
    Ok((measured, notes))
}

/// The value that `part` of the sorted values do not exceed; `None` without values.
fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = ((sorted.len() as f64 * part).ceil() as usize).saturating_sub(1);
    sorted.get(at).copied()
}

fn shown(ms: Option<f64>) -> String {
    ms.map_or_else(|| "-".into(), |ms| format!("{ms:.3}"))
}

fn table(m: &Measured) -> String {
    let mut text = format!("{}, {} frames\n    median       p99  ms on the GPU\n", m.adapter, m.frames);
    let mut line = |values: &[f64], name: &str| {
        let (median, p99) = (shown(quantile(values, 0.5)), shown(quantile(values, 0.99)));
        _ = writeln!(text, "{median:>10}{p99:>10}  {name}");
    };
    m.passes.iter().for_each(|(name, values)| line(values, name));
    line(&m.gpu_ms, "all passes");
    line(&m.encode_ms, "encoding, on the CPU");
    let [held, unshared, lower] = [m.memory_bytes, m.unshared_bytes, m.lower_bound_bytes].map(bytes);
    _ = writeln!(text, "memory: {held} held; {unshared} without reuse, {lower} live at once");
    text
}

fn as_json(m: &Measured) -> serde_json::Value {
    let times = |values: &[f64]| json!({"median_ms": quantile(values, 0.5), "p99_ms": quantile(values, 0.99)});
    let passes: Vec<_> = (m.passes.iter()).map(|(name, values)| json!({"pass": name, "gpu": times(values)})).collect();
    json!({
        "adapter": m.adapter, "frames": m.frames, "passes": passes, "gpu": times(&m.gpu_ms), "encode": times(&m.encode_ms),
        "memory": {"held_bytes": m.memory_bytes, "unshared_bytes": m.unshared_bytes, "lower_bound_bytes": m.lower_bound_bytes},
    })
}

fn csv(m: &Measured) -> String {
    let mut text = String::from("what,median_ms,p99_ms\n");
    let number = |ms: Option<f64>| ms.map_or_else(String::new, |ms| format!("{ms:.6}"));
    let all = m.passes.iter().map(|(name, values)| (name.as_str(), values));
    for (name, values) in all.chain([("gpu", &m.gpu_ms), ("encode", &m.encode_ms)]) {
        _ = writeln!(text, "{name},{},{}", number(quantile(values, 0.5)), number(quantile(values, 0.99)));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_were_measured() {
        let values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(quantile(&values, 0.5), Some(50.0));
        assert_eq!(quantile(&values, 0.99), Some(99.0));
        assert_eq!(quantile(&[3.0], 0.99), Some(3.0));
        assert_eq!(quantile(&[], 0.5), None);
    }
}
