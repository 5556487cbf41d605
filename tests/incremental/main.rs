//! Only what changed runs, and nobody can tell: whatever changes from frame to frame, what is
//! skipped is what would have come out the same.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../support/generate.rs"]
mod generate;
#[path = "../support/golden.rs"]
mod golden;
#[path = "../engine/harness.rs"]
mod harness;
mod peak;
#[path = "../support/planning.rs"]
mod planning;
mod poison;
mod random;
mod shipped;
mod small;
mod transient;
mod world;

use std::process::{Command, ExitCode};

/// How many threads Mesa's software driver takes. With one, atomics come in one order, and two full runs of a frame are
/// the same to the byte.
const THREADS: &str = "LP_NUM_THREADS";

fn main() -> ExitCode {
    if std::env::var_os(THREADS).is_none_or(|count| count != "1") {
        // The driver reads it when it is loaded, and the variables of a process that runs are not safe to change.
        let again = std::env::current_exe()
            .and_then(|exe| Command::new(exe).args(std::env::args_os().skip(1)).env(THREADS, "1").status());
        let code = again.expect("a test program starts itself").code();
        return code.and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from);
    }
    harness::run(cases![
        random::pictures_equal_those_of_full_runs,
        random::a_cause_that_was_dropped_is_caught,
        random::a_reader_that_was_forgotten_is_caught,
        random::memory_shared_by_what_lives_together_is_caught,
        random::shared_memory_holds_nothing_that_is_missed,
        small::what_reads_overwritten_memory_has_it_written_again,
        small::a_way_back_that_was_forgotten_is_seen,
        small::steps_alone_make_their_readers_run,
        small::others_resources_count_by_their_version,
        small::a_runner_that_takes_from_another_runs_when_that_did,
        small::what_was_left_out_runs_later,
        small::everything_runs_if_asked_for,
        small::counts_of_what_was_skipped_stay,
        small::a_branch_with_a_count_settles_nothing_anew,
        small::a_draw_of_another_count_runs,
        small::arguments_that_nobody_gave_are_seen,
        peak::a_cut_that_is_left_out_is_caught,
        peak::memory_that_is_given_back_too_early_is_caught,
        peak::commands_of_others_are_not_cut,
        transient::pictures_are_those_of_what_is_stored,
        transient::a_render_pass_that_is_parted_stores,
        transient::a_draw_alone_of_its_render_pass_clears,
        shipped::each_has_its_cases,
        shipped::imai2014::orbiting_runs_what_sees_the_camera,
        shipped::imai2014::a_camera_that_was_forgotten_is_caught,
        shipped::imai2014::a_parameter_runs_what_has_it_as_a_cause,
        shipped::imai2014::another_parameter_runs_what_has_it_as_a_cause,
        shipped::imai2014::pictures_equal_those_of_full_runs,
        shipped::imai2014::shared_memory_holds_nothing_that_is_missed,
        shipped::imai2014::the_smallest_policy_holds_what_its_plan_says,
        shipped::imai2016::orbiting_runs_what_sees_the_camera,
        shipped::imai2016::a_camera_that_was_forgotten_is_caught,
        shipped::imai2016::a_parameter_runs_what_has_it_as_a_cause,
        shipped::imai2016::another_parameter_runs_what_has_it_as_a_cause,
        shipped::imai2016::pictures_equal_those_of_full_runs,
        shipped::imai2016::shared_memory_holds_nothing_that_is_missed,
        shipped::imai2016::the_smallest_policy_holds_what_its_plan_says,
        shipped::iwasaki2006::orbiting_runs_what_sees_the_camera,
        shipped::iwasaki2006::a_camera_that_was_forgotten_is_caught,
        shipped::iwasaki2006::a_parameter_runs_what_has_it_as_a_cause,
        shipped::iwasaki2006::another_parameter_runs_what_has_it_as_a_cause,
        shipped::iwasaki2006::pictures_equal_those_of_full_runs,
        shipped::iwasaki2006::shared_memory_holds_nothing_that_is_missed,
        shipped::iwasaki2006::the_smallest_policy_holds_what_its_plan_says,
        shipped::ripples::orbiting_runs_what_sees_the_camera,
        shipped::ripples::a_camera_that_was_forgotten_is_caught,
        shipped::ripples::a_parameter_runs_what_has_it_as_a_cause,
        shipped::ripples::another_parameter_runs_what_has_it_as_a_cause,
        shipped::ripples::pictures_equal_those_of_full_runs,
        shipped::ripples::shared_memory_holds_nothing_that_is_missed,
        shipped::ripples::the_smallest_policy_holds_what_its_plan_says,
    ])
}
