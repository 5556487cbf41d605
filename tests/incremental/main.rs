//! Only what changed runs, and nobody can tell: whatever changes from frame to frame, what is
//! skipped is what would have come out the same.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../support/generate.rs"]
mod generate;
#[path = "../engine/harness.rs"]
mod harness;
mod world;

mod random;

use std::process::ExitCode;

fn main() -> ExitCode {
    harness::run(cases![
        random::pictures_equal_those_of_full_runs,
        random::a_cause_that_was_dropped_is_caught,
        random::a_reader_that_was_forgotten_is_caught,
        random::memory_shared_by_what_lives_together_is_caught,
        random::shared_memory_holds_nothing_that_is_missed,
    ])
}
