//! The engine carries out plans as they say, read back from a real device.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod bad_input;
mod blended;
mod cameras;
mod compute;
mod distance;
mod draw;
mod embed;
mod everything;
mod harness;
mod lifecycle;
mod maps;
mod meshes;
mod samples;
mod shipped;
mod statistics;
mod steps;
mod submerged;
mod support;
mod transfer;

use std::process::ExitCode;

fn main() -> ExitCode {
    harness::run(cases![
        compute::reads_and_writes_buffers,
        compute::zero_workgroups_are_skipped,
        compute::counts_drive_dispatches,
        compute::an_overflow_is_clamped_and_told,
        compute::a_count_of_zero_dispatches_nothing,
        compute::more_than_65535_groups_are_folded,
        compute::dispatches_share_a_pass,
        compute::shared_passes_have_one_time,
        draw::fullscreen_has_uv_from_the_top_left,
        draw::two_draws_add_into_32_bit_floats,
        draw::minimum_and_masks_hold,
        draw::several_targets_of_several_kinds,
        draw::nearest_and_farthest_of_reversed_depth,
        draw::depth_is_tested_and_sampled_in_one_pass,
        draw::stencil_marks_and_masks,
        draw::samples_are_resolved,
        draw::a_region_is_viewport_and_scissor,
        draw::nothing_to_draw_still_clears,
        draw::indices_choose_vertices,
        draw::counts_drive_draws,
        draw::a_shader_writes_draw_arguments,
        draw::draws_that_need_each_other_share_no_render_pass,
        transfer::clears_touch_only_their_view,
        transfer::volumes_are_cleared_slice_by_slice,
        transfer::depth_is_cleared,
        transfer::buffers_clear_to_words_of_their_type,
        transfer::copies_of_views_and_buffers,
        transfer::mips_keep_the_mean_of_each_layer,
        transfer::mips_of_two_by_two_are_their_mean,
        transfer::mips_of_volumes_are_stored,
        steps::uniforms_are_packed_where_the_shader_has_them,
        steps::state_swaps_over_steps_and_frames,
        steps::a_thousand_steps_in_a_frame,
        steps::state_goes_on_unless_its_key_changes,
        steps::the_host_answers_with_values_of_the_step,
        steps::chosen_passes_alone_run,
        lifecycle::pipelines_are_found_again,
        lifecycle::a_failure_leaves_the_runner_before,
        lifecycle::a_lacking_feature_is_told_by_name,
        lifecycle::passes_are_timed,
        lifecycle::a_texture_goes_from_graph_to_graph,
        lifecycle::objects_share_memory_as_the_policy_says,
        lifecycle::samplers_filter_or_not,
        lifecycle::a_lost_device_is_told_as_such,
        lifecycle::an_unknown_backend_is_told,
        lifecycle::poison_shows_holes,
        lifecycle::a_device_may_come_from_outside,
        embed::frames_go_into_their_commands,
        embed::dropped_commands_leave_no_trace,
        embed::a_texture_of_theirs_is_checked,
        embed::what_is_not_in_the_plan_is_told,
        embed::a_texture_that_they_destroy_is_told,
        embed::two_graphs_do_not_write_one_texture,
        embed::another_engine_knows_what_is_written,
        embed::instances_share_pipelines_and_inputs,
        embed::the_smallest_and_the_largest_sizes_work,
        bad_input::a_parameter_changed_a_thousand_times_in_a_frame,
        bad_input::shipped_graphs_draw_one_pixel,
        bad_input::shipped_graphs_at_the_largest_size,
        meshes::bodies_stand_where_the_scene_says,
        meshes::fronts_stay_fronts,
        meshes::tags_and_values_and_computed_bodies,
        meshes::absent_meshes_are_no_bodies,
        meshes::materials_are_bound_by_name,
        cameras::stand_where_their_node_does,
        cameras::move_as_their_node_does,
        cameras::that_cannot_be_looked_through_are_told,
        meshes::animations_move_nodes,
        meshes::what_turns_inside_out_on_its_way_stays_seen,
        meshes::what_blends_goes_from_back_to_front,
        meshes::steps_see_meshes_move,
        meshes::steps_before_those_that_see_meshes_are_done_before,
        meshes::bounds_cover_animations,
        meshes::scenes_without_particles_are_dry,
        meshes::an_even_sky_makes_white_things_as_bright_as_it,
        meshes::meshes_cast_shadows_on_meshes,
        meshes::what_does_not_fit_is_told,
        distance::of_a_box,
        distance::of_a_sphere,
        distance::of_several_bodies,
        submerged::what_stands_in_the_liquid_is_seen_through_it,
        submerged::what_stands_before_the_liquid_hides_it,
        submerged::what_rays_pass_on_their_way_is_met,
        blended::the_liquid_is_seen_through_glass_before_it,
        blended::glass_behind_the_liquid_is_seen_through_it,
        samples::samples_look_as_their_files_say,
        samples::the_animated_sample_moves_as_its_file_says,
        maps::normal_maps_turn_normals,
        maps::green_is_rough_and_blue_is_metal,
        maps::red_keeps_the_light_of_the_sky_out,
        maps::what_glows_needs_no_light,
        everything::files_beside_the_repository_render,
        statistics::statistics_are_what_buffers_hold,
        statistics::what_only_statistics_need_runs_when_they_are_asked_for,
        shipped::imai2016,
        shipped::imai2014,
        shipped::iwasaki2006,
    ])
}
