//! Whether two measurements differ by more than chance.
//!
//! What else a machine does changes slowly, so frames that follow each other are alike and no
//! independent draws. They are put together to a few batches, whose medians are nearly so; how
//! these scatter gives the interval (batch means, with Student's t). Frames of one process that
//! took turns are compared pair by pair. Two processes differ by where their memory came to lie
//! and by what the machine did meanwhile, too; there a difference counts only beyond a margin.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::{Measured, quantile};

/// Batches of frames that follow each other.
const BATCHES: usize = 6;
/// Student's t with one degree of freedom less than batches, for 98 % on both sides: batches that
/// follow each other are still a little alike, which leaves about 95 % (measured in a test).
const T: f64 = 3.365;
/// Fewer frames tell nothing.
const LEAST: usize = 2 * BATCHES;
/// By what part measurements of two processes differ without a cause.
const MARGIN: f64 = 0.03;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Comparison {
    /// What the measurement is compared with.
    before: String,
    is_paired: bool,
    /// Why they are not of the same thing, if so.
    caution: Vec<String>,
    rows: Vec<Row>,
}

/// Parameters of other values that are named.
const MOST_PARAMS: usize = 5;

#[derive(Clone, Debug, PartialEq)]
struct Row {
    what: &'static str,
    before_ms: Option<f64>,
    now_ms: Option<f64>,
    /// Now to before: low, middle and high of 95 %.
    ratio: Option<[f64; 3]>,
    verdict: Verdict,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Slower,
    Faster,
    None,
    TooFew,
}

impl Verdict {
    fn text(self) -> &'static str {
        match self {
            Verdict::Slower => "slower",
            Verdict::Faster => "faster",
            Verdict::None => "no difference that can be told",
            Verdict::TooFew => "too few frames to tell",
        }
    }
}

impl Comparison {
    /// Of frames that took turns in one process.
    pub fn paired(before: &Measured, now: &Measured) -> Self {
        Self::new(before, now, true)
    }

    /// Of two processes.
    pub fn apart(before: &Measured, now: &Measured) -> Self {
        Self::new(before, now, false)
    }

    fn new(before: &Measured, now: &Measured, is_paired: bool) -> Self {
        let row = |what, a: &[f64], b: &[f64]| {
            let ratio = ratio(a, b, is_paired);
            let margin = if is_paired { 0.0 } else { MARGIN };
            let verdict = match ratio {
                None => Verdict::TooFew,
                Some([low, ..]) if low > 1.0 + margin => Verdict::Slower,
                Some([.., high]) if high < 1.0 - margin => Verdict::Faster,
                Some(_) => Verdict::None,
            };
            Row { what, before_ms: quantile(a, 0.5), now_ms: quantile(b, 0.5), ratio, verdict }
        };
        let mut caution = otherwise_done(before, now, is_paired);
        if before.adapter != now.adapter {
            caution.push(format!("it was measured on {}", before.adapter));
        }
        if before.size != now.size {
            caution.push(format!("its pictures have {} x {} pixels", before.size[0], before.size[1]));
        }
        if before.scene != now.scene && !is_paired {
            caution.push(format!("it is of {}", before.scene));
        }
        Self {
            before: before.scene.clone(),
            is_paired,
            caution,
            rows: vec![
                row("gpu", &before.gpu_ms, &now.gpu_ms),
                row("encode", &before.encode_ms, &now.encode_ms),
                row("submit", &before.submit_ms, &now.submit_ms),
            ],
        }
    }

    pub fn is_slower(&self) -> bool {
        self.rows.iter().any(|row| row.verdict == Verdict::Slower)
    }

    pub fn text(&self) -> String {
        let how = if self.is_paired { "frame by frame in turn" } else { "measured apart" };
        let mut text = format!("against {} ({how}):\n", self.before);
        for caution in &self.caution {
            _ = writeln!(text, "  mind that {caution}");
        }
        let ms = |ms: Option<f64>| ms.map_or_else(|| "-".to_owned(), |ms| format!("{ms:.3}"));
        for row in &self.rows {
            let percent = |x: f64| (x - 1.0) * 100.0;
            let by = row.ratio.map_or_else(String::new, |[low, middle, high]| {
                format!(", {:+.1} % ({:+.1} to {:+.1})", percent(middle), percent(low), percent(high))
            });
            _ = writeln!(
                text,
                "  {:<7} {:>9} -> {:>9} ms  {}{by}",
                row.what,
                ms(row.before_ms),
                ms(row.now_ms),
                row.verdict.text()
            );
        }
        text
    }

    pub fn json(&self) -> Value {
        let row = |row: &Row| {
            json!({
                "what": row.what, "before_ms": row.before_ms, "now_ms": row.now_ms,
                "ratio": row.ratio.map(|[_, middle, _]| middle),
                "ratio_95": row.ratio.map(|[low, _, high]| [low, high]),
                "verdict": row.verdict.text(),
            })
        };
        json!({
            "with": self.before, "paired": self.is_paired, "cautions": self.caution,
            "rows": self.rows.iter().map(row).collect::<Vec<_>>(),
        })
    }
}

/// What else was another way before, as far as that was noted. Of scenes that take turns, that is what is compared.
fn otherwise_done(before: &Measured, now: &Measured, is_paired: bool) -> Vec<String> {
    let mut said = Vec::new();
    if before.memory.policy != now.memory.policy && !before.memory.policy.is_empty() {
        said.push(format!("it held memory by the policy `{}`", before.memory.policy));
    }
    if is_paired || before.graph.is_empty() {
        return said;
    }
    if before.graph != now.graph {
        said.push(format!("it was drawn by {}", before.graph));
    }
    let others = now.params.iter().filter_map(|(path, value)| {
        let was = before.params.get(path).filter(|was| *was != value)?;
        Some(format!("its `{path}` was {was}"))
    });
    said.extend(others.take(MOST_PARAMS));
    said
}

/// The ratio of the typical frames with the bounds of 95 %: low, middle, high.
fn ratio(before: &[f64], now: &[f64], is_paired: bool) -> Option<[f64; 3]> {
    if before.len().min(now.len()) < LEAST || before.iter().chain(now).any(|ms| *ms <= 0.0) {
        return None;
    }
    let (middle, spread) = if is_paired {
        let (mean, variance) = batches(before.iter().zip(now).map(|(a, b)| (b / a).ln()).collect());
        (mean, variance)
    } else {
        let log = |values: &[f64]| batches(values.iter().map(|ms| ms.ln()).collect());
        let ((a, of_a), (b, of_b)) = (log(before), log(now));
        (b - a, of_a + of_b)
    };
    let half = T * (spread / BATCHES as f64).sqrt();
    Some([middle - half, middle, middle + half].map(f64::exp))
}

/// The mean and the variance of the batches' medians.
fn batches(values: Vec<f64>) -> (f64, f64) {
    let n = values.len();
    let medians = (0..BATCHES).map(|i| median(values[i * n / BATCHES..(i + 1) * n / BATCHES].to_vec()));
    let medians: Vec<f64> = medians.collect();
    let mean = medians.iter().sum::<f64>() / BATCHES as f64;
    let squares: f64 = medians.iter().map(|m| (m - mean).powi(2)).sum();
    (mean, squares / (BATCHES - 1) as f64)
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marsaglia's xorshift: the same draws in each run.
    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 % 10_000) as f64 / 10_000.0
        }
    }

    /// Times around a level, with frames in a row alike and now and then a very slow one.
    fn noisy(level: f64, frames: usize, random: &mut Random) -> Vec<f64> {
        let mut drift = 0.0;
        let mut unit = || random.unit();
        (0..frames)
            .map(|_| {
                drift = 0.8 * drift + 0.02 * (unit() - 0.5);
                let slow = if unit() > 0.95 { 3.0 } else { 1.0 };
                level * slow * (1.0 + drift + 0.05 * (unit() - 0.5))
            })
            .collect()
    }

    fn verdict(before: Vec<f64>, now: Vec<f64>, is_paired: bool) -> Verdict {
        let of = |encode_ms| Measured { encode_ms, ..Measured::default() };
        Comparison::new(&of(before), &of(now), is_paired).rows[1].verdict
    }

    #[test]
    fn noise_is_no_difference() {
        let mut random = Random(7);
        for is_paired in [false, true] {
            let told = (0..100)
                .filter(|_| {
                    let (a, b) = (noisy(2.0, 60, &mut random), noisy(2.0, 60, &mut random));
                    verdict(a, b, is_paired) != Verdict::None
                })
                .count();
            // At 95 %, with frames that hang together.
            assert!(told <= 12, "{told} of 100 equal measurements were told apart, paired: {is_paired}");
        }
    }

    #[test]
    fn a_difference_is_told() {
        let mut random = Random(8);
        for is_paired in [false, true] {
            for _ in 0..20 {
                let (a, b) = (noisy(2.0, 60, &mut random), noisy(2.3, 60, &mut random));
                assert_eq!(verdict(a.clone(), b.clone(), is_paired), Verdict::Slower);
                assert_eq!(verdict(b, a, is_paired), Verdict::Faster);
            }
        }
    }

    #[test]
    fn what_is_shared_by_pairs_is_no_difference() {
        // The machine becomes twice as slow half way; both see it.
        let level = |frame: usize| if frame < 30 { 1.0 } else { 2.0 };
        let both: Vec<f64> = (0..60).map(|f| level(f) * (1.0 + 0.001 * (f % 7) as f64)).collect();
        let slower: Vec<f64> = both.iter().map(|ms| ms * 1.05).collect();
        assert_eq!(verdict(both.clone(), both.clone(), true), Verdict::None);
        assert_eq!(verdict(both, slower, true), Verdict::Slower);
    }

    #[test]
    fn few_frames_tell_nothing() {
        assert_eq!(verdict(vec![1.0; 11], vec![9.0; 11], true), Verdict::TooFew);
        assert_eq!(verdict(Vec::new(), vec![9.0; 70], false), Verdict::TooFew);
    }
}
