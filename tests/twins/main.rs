//! The methods' kernels against twins in 64-bit floats and closed forms.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod ball;
mod device;
mod grid;
#[path = "../engine/harness.rs"]
mod harness;
mod particles;
mod pool;
mod shapes;
mod surfaces;

use std::process::ExitCode;

fn main() -> ExitCode {
    harness::run(cases![
        particles::grid_of_none_one_and_seven,
        particles::grid_of_a_few_thousand,
        particles::grid_of_a_million,
        particles::grid_with_all_in_one_cell,
        particles::grid_with_some_far_out,
        particles::ellipsoids_of_the_dam_break,
        particles::ellipsoids_of_third_parties,
        particles::ellipsoids_of_lone_and_heaped_particles,
        pool::state_does_not_depend_on_the_pictures,
        pool::a_step_is_its_twin_in_64_bits,
        pool::waves_travel_at_the_speed_of_the_equation,
        pool::energy_does_not_grow,
        pool::the_measure_of_energy_sees_one_that_grows,
        surfaces::a_splash_is_a_glass_ball,
        surfaces::tilted_planes_stay_planes,
        surfaces::noise_falls_more_than_by_the_bilateral_filter,
        surfaces::rims_stay_where_they_are,
    ])
}
