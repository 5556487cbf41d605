//! A measurement as JSON, written and read again; `docs/benchmarks.md` has its fields.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json};

use super::compare::Comparison;
use super::{Measured, Memory, PassTimes, quantile};
use crate::diagnostic::{Code, Diagnostic};

/// Changes when a field is renamed or gone, not when one is added.
const VERSION: u64 = 1;

pub(super) fn json(m: &Measured, comparison: Option<&Comparison>) -> Value {
    let times = |values: &[f64]| json!({"median_ms": quantile(values, 0.5), "p99_ms": quantile(values, 0.99), "samples_ms": values});
    let pass = |pass: &PassTimes| {
        let (gpu, record) = (times(&pass.gpu_ms), times(&pass.record_ms));
        json!({"pass": pass.path, "gpu": gpu, "record": record, "timed_with": pass.timed_with})
    };
    let mut value = json!({
        "version": VERSION,
        "scene": m.scene,
        "adapter": m.adapter,
        "graph": m.graph,
        "params": m.params,
        "size": m.size,
        "frames": m.frames,
        "passes": m.passes.iter().map(pass).collect::<Vec<_>>(),
        "gpu": times(&m.gpu_ms),
        "encode": times(&m.encode_ms),
        "submit": times(&m.submit_ms),
        "counters": {
            "passes": m.counters.passes,
            "compute_passes": m.counters.compute_passes,
            "render_passes": m.counters.render_passes,
            "submissions": m.counters.submissions,
            "uploaded_bytes": m.counters.uploaded_bytes,
        },
        "memory": {
            "policy": m.memory.policy,
            "held_bytes": m.memory.held_bytes,
            "unshared_bytes": m.memory.unshared_bytes,
            "lower_bound_bytes": m.memory.lower_bound_bytes,
        },
        "statistics": m.statistics.iter().map(|s| (s.path.clone(), json!(s.value))).collect::<BTreeMap<_, _>>(),
        "changes": super::changes::json(&m.changes),
    });
    if let Some(comparison) = comparison {
        value["comparison"] = comparison.json();
    }
    value
}

/// What a comparison needs of an earlier measurement.
///
/// # Errors
/// If the file cannot be read or holds no measurement.
pub(super) fn read(path: &Path) -> Result<Measured, Diagnostic> {
    let shown = path.display();
    let text = std::fs::read_to_string(path)
        .map_err(|e| Diagnostic::error(Code::FILE_UNREADABLE, format!("cannot read the measurement `{shown}`: {e}")))?;
    let no = |why: &str| {
        Diagnostic::error(Code::FILE_UNREADABLE, format!("`{shown}` is no measurement: {why}"))
            .hint("make one with `meniscus bench SCENE --format json > FILE`")
    };
    let value: Value = serde_json::from_str(&text).map_err(|e| no(&e.to_string()))?;
    match value["version"].as_u64() {
        Some(VERSION) => {}
        Some(other) => return Err(no(&format!("its version is {other}, and this program reads {VERSION}"))),
        None => return Err(no("it has no `version`")),
    }
    let samples = |what: &str| -> Result<Vec<f64>, Diagnostic> {
        let list = value[what]["samples_ms"].as_array().ok_or_else(|| no(&format!("it has no `{what}.samples_ms`")))?;
        Ok(list.iter().filter_map(Value::as_f64).collect())
    };
    let text = |what: &str| value[what].as_str().unwrap_or_default().to_owned();
    let size = |i: usize| value["size"][i].as_u64().and_then(|n| u32::try_from(n).ok()).unwrap_or(0);
    let params = value["params"].as_object().into_iter().flatten();
    let params = params.filter_map(|(path, value)| Some((path.clone(), value.as_str()?.to_owned()))).collect();
    let policy = value["memory"]["policy"].as_str().unwrap_or_default().to_owned();
    Ok(Measured {
        graph: text("graph"),
        params,
        memory: Memory { policy, ..Memory::default() },
        scene: text("scene"),
        adapter: text("adapter"),
        size: [size(0), size(1)],
        gpu_ms: samples("gpu")?,
        encode_ms: samples("encode")?,
        submit_ms: samples("submit")?,
        ..Measured::default()
    })
}
