//! How long the interface's own thread works at a time: what a person feels as a stutter.

use std::time::Duration;

/// Pieces of work that are remembered.
const MOST: usize = 100_000;

/// Pieces of work of the interface's thread.
#[derive(Clone, Debug, Default)]
pub struct Pace {
    /// Painting the interface, with the wait for the screen. Milliseconds.
    painting: Vec<f32>,
    /// What is done between paints: news taken, frames submitted, plans swapped in.
    between: Vec<f32>,
}

impl Pace {
    pub fn painted(&mut self, took: Duration) {
        remember(&mut self.painting, took);
    }

    pub fn worked(&mut self, took: Duration) {
        remember(&mut self.between, took);
    }

    /// In words.
    pub fn line(&self) -> String {
        let [p50, p99, most] = percentiles(&self.painting);
        let [.., between] = percentiles(&self.between);
        let count = self.painting.len();
        format!(
            "interface: {count} paints, p50 {p50:.1} ms, p99 {p99:.1} ms, longest {most:.1} ms; longest work between two \
             {between:.1} ms"
        )
    }
}

fn remember(all: &mut Vec<f32>, took: Duration) {
    if all.len() < MOST {
        all.push(took.as_secs_f32() * 1e3);
    }
}

/// Of 50 %, of 99 %, and the largest.
fn percentiles(all: &[f32]) -> [f32; 3] {
    let mut sorted = all.to_vec();
    sorted.sort_by(f32::total_cmp);
    let at = |share: f64| sorted.get(((sorted.len().max(1) - 1) as f64 * share).round() as usize).copied();
    [0.5, 0.99, 1.0].map(|share| at(share).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_is_told_however_rare() {
        let mut pace = Pace::default();
        (0..200).for_each(|_| pace.painted(Duration::from_millis(4)));
        pace.painted(Duration::from_millis(80));
        pace.worked(Duration::from_millis(7));
        let said = "interface: 201 paints, p50 4.0 ms, p99 4.0 ms, longest 80.0 ms; longest work between two 7.0 ms";
        assert_eq!(pace.line(), said);
        assert!(Pace::default().line().starts_with("interface: 0 paints, p50 0.0 ms"));
    }
}
