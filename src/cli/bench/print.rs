//! What was measured, as a table for people and as CSV.

use std::fmt::Write as _;

use super::compare::Comparison;
use super::{Measured, quantile};
use crate::plan::print::bytes;

fn shown(ms: Option<f64>) -> String {
    ms.map_or_else(|| "-".into(), |ms| format!("{ms:.3}"))
}

pub(super) fn table(m: &Measured, comparison: Option<&Comparison>) -> String {
    let [width, height] = m.size;
    let mut text = format!(
        "{} at {width} x {height} on {}, {} frames\n    median       p99       CPU  ms on the GPU, and of recording on the CPU\n",
        m.scene, m.adapter, m.frames
    );
    let mut line = |values: &[f64], record: &[f64], name: &str| {
        let (median, p99) = (shown(quantile(values, 0.5)), shown(quantile(values, 0.99)));
        let record = quantile(record, 0.5).map_or_else(String::new, |ms| format!("{ms:.4}"));
        _ = writeln!(text, "{median:>10}{p99:>10}{record:>10}  {name}");
    };
    for pass in &m.passes {
        match &pass.timed_with {
            Some(with) => line(&[], &pass.record_ms, &format!("{} (in the time of {with})", pass.path)),
            None => line(&pass.gpu_ms, &pass.record_ms, &pass.path),
        }
    }
    line(&m.gpu_ms, &[], "all passes");
    line(&m.encode_ms, &[], "encoding, on the CPU");
    line(&m.submit_ms, &[], "submitting, on the CPU");
    let c = &m.counters;
    _ = writeln!(
        text,
        "a frame: {} passes in {} compute and {} render passes of the device, {} submissions, {} uploaded",
        c.passes,
        c.compute_passes,
        c.render_passes,
        c.submissions,
        bytes(c.uploaded_bytes)
    );
    let [held, unshared, lower] = [m.memory.held_bytes, m.memory.unshared_bytes, m.memory.lower_bound_bytes].map(bytes);
    _ = writeln!(
        text,
        "memory: {held} held, policy \"{}\"; of the frame {unshared} without sharing, {lower} in the largest live set",
        m.memory.policy
    );
    for statistic in &m.statistics {
        let value = statistic.value.map_or_else(|| "no value".to_owned(), |value| value.to_string());
        _ = writeln!(text, "{}: {value}", statistic.path);
    }
    text.push_str(&super::changes::text(&m.changes));
    if let Some(comparison) = comparison {
        text.push_str(&comparison.text());
    }
    text
}

pub(super) fn csv(m: &Measured) -> String {
    let mut text = String::from("what,median_ms,p99_ms\n");
    let number = |ms: Option<f64>| ms.map_or_else(String::new, |ms| format!("{ms:.6}"));
    let all = m.passes.iter().map(|pass| (pass.path.as_str(), &pass.gpu_ms));
    for (name, values) in all.chain([("gpu", &m.gpu_ms), ("encode", &m.encode_ms), ("submit", &m.submit_ms)]) {
        _ = writeln!(text, "{name},{},{}", number(quantile(values, 0.5)), number(quantile(values, 0.99)));
    }
    text
}
