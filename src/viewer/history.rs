//! Times over the last frames: each new one, a smoothed one, and the row of them.

use std::collections::{BTreeMap, VecDeque};

use crate::engine::Report;

/// Frames that are remembered.
pub const LENGTH: usize = 90;
/// The part of a new value in the smoothed one.
const SHARE: f64 = 0.15;
/// A value below this part of the smoothed one takes its place.
const DROP: f64 = 0.6;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Milliseconds, the newest last.
    pub values: VecDeque<f64>,
    pub smooth: f64,
}

impl Series {
    pub fn push(&mut self, ms: f64) {
        if !ms.is_finite() {
            return;
        }
        // What took much longer once, as a first frame does, is not dragged along.
        let is_new = self.values.is_empty() || ms < self.smooth * DROP;
        self.smooth = if is_new { ms } else { self.smooth + (ms - self.smooth) * SHARE };
        self.values.push_back(ms);
        if self.values.len() > LENGTH {
            self.values.pop_front();
        }
    }

    pub fn largest(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }
}

/// What is known of the times of passes.
#[derive(Clone, Debug, Default)]
pub struct Times {
    passes: BTreeMap<String, Series>,
    recording: BTreeMap<String, Series>,
    pub gpu: Series,
    pub encode: Series,
    /// The newest report.
    pub last: Option<Report>,
}

impl Times {
    pub fn take(&mut self, report: Report) {
        for pass in &report.passes {
            if let Some(ms) = pass.gpu_ms {
                self.passes.entry(pass.path.clone()).or_default().push(ms);
            }
            if let Some(ms) = pass.record_ms {
                self.recording.entry(pass.path.clone()).or_default().push(ms);
            }
        }
        if let Some(ms) = report.gpu_ms() {
            self.gpu.push(ms);
        }
        self.encode.push(report.encode_ms);
        self.last = Some(report);
    }

    pub fn pass(&self, path: &str) -> Option<&Series> {
        self.passes.get(path)
    }

    /// CPU time of recording a pass.
    pub fn recording(&self, path: &str) -> Option<&Series> {
        self.recording.get(path)
    }

    /// Forgets passes that are not there any more.
    pub fn keep(&mut self, is_there: impl Fn(&str) -> bool) {
        self.passes.retain(|path, _| is_there(path));
        self.recording.retain(|path, _| is_there(path));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_remembers_a_while_and_smooths() {
        let mut series = Series::default();
        series.push(10.0);
        assert_eq!(series.smooth, 10.0);
        (0..200).for_each(|_| series.push(20.0));
        assert_eq!(series.values.len(), LENGTH);
        assert!((series.smooth - 20.0).abs() < 1e-3);
        series.push(1.0);
        assert_eq!(series.smooth, 1.0);
        series.push(20.0);
        series.push(f64::NAN);
        assert_eq!((series.largest(), series.values.len()), (20.0, LENGTH));
    }
}
