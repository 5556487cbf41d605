//! Times as a table for people.

use std::fmt::Write as _;

use crate::engine::Report;

/// A line for each pass that ran: its time on the GPU, and how often it ran.
pub fn passes(reports: &[Report]) -> String {
    let mut text = String::from("    GPU ms   runs  pass\n");
    for pass in reports.iter().flat_map(|r| &r.passes) {
        // One that shares another's time has none of its own.
        let none = || if pass.timed_with.is_some() { "\"".to_owned() } else { "-".to_owned() };
        let ms = pass.gpu_ms.map_or_else(none, |ms| format!("{ms:.3}"));
        _ = writeln!(text, "{ms:>10} {:>6}  {}", pass.runs, pass.path);
    }
    let total: Option<f64> = reports.iter().map(Report::gpu_ms).sum();
    let total = total.map_or_else(|| "-".to_owned(), |ms| format!("{ms:.3}"));
    let encode_ms: f64 = reports.iter().map(|r| r.encode_ms).sum();
    _ = writeln!(text, "{total:>10}         on the GPU together; {encode_ms:.3} ms encoding on the CPU");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::PassReport;

    #[test]
    fn passes_are_listed_in_order_with_their_sum() {
        let pass = |path: &str, gpu_ms| PassReport { path: path.into(), runs: 1, gpu_ms, ..PassReport::default() };
        let report = |passes| Report { passes, encode_ms: 0.25, ..Report::default() };
        let timed = passes(&[report(vec![pass("grid/scan", Some(1.5)), pass("shade", Some(2.25))])]);
        let expected = "    GPU ms   runs  pass\n     1.500      1  grid/scan\n     2.250      1  shade\n     3.750         on the GPU together; 0.250 ms encoding on the CPU\n";
        assert_eq!(timed, expected);
        assert!(passes(&[report(vec![pass("a", None)])]).contains("         -      1  a"));
    }
}
