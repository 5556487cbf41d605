//! The methods' kernels against twins in 64-bit floats and closed forms.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod ball;
mod device;
mod field;
mod foam;
mod grid;
#[path = "../engine/harness.rs"]
mod harness;
mod holes;
mod light;
mod particles;
mod points;
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
        particles::strays_are_small_groups,
        particles::strays_do_not_depend_on_the_order_of_threads,
        pool::state_does_not_depend_on_the_pictures,
        pool::a_step_is_its_twin_in_64_bits,
        pool::waves_travel_at_the_speed_of_the_equation,
        pool::energy_does_not_grow,
        pool::the_measure_of_energy_sees_one_that_grows,
        surfaces::a_splash_is_a_glass_ball,
        surfaces::tilted_planes_stay_planes,
        surfaces::noise_falls_more_than_by_the_bilateral_filter,
        surfaces::rims_stay_where_they_are,
        holes::no_holes_from_anywhere,
        light::level_water_passes_the_flux,
        light::waves_keep_the_light,
        light::cut_cells_come_near_to_many_beams,
        light::a_wave_focuses_as_a_lens_does,
        light::a_body_of_ellipsoids_keeps_the_light,
        light::light_from_below_lights_nothing,
        foam::droplets_are_capsules_along_their_motion,
        foam::motion_smears_a_droplet_and_takes_nothing_from_it,
        foam::the_order_of_droplets_does_not_count,
        foam::below_the_surface_they_are_where_it_bends_their_light_from,
        points::densities_are_the_sums,
        points::surfels_lie_on_the_surface,
        points::layouts_agree,
        points::densities_go_on_behind_floor_and_walls,
        points::no_particles_and_no_level,
        points::as_many_surfels_as_in_the_paper,
    ])
}
