// Linear index of a one-dimensional dispatch, which the engine folds into rows beyond 65,535 workgroups.

/// Number of this thread, counted over all rows; `width` is the workgroup's size.
fn linear_index(global_id: vec3u, groups: vec3u, width: u32) -> u32 {
    return global_id.y * groups.x * width + global_id.x;
}

/// Number of this workgroup, counted over all rows.
fn linear_group(group_id: vec3u, groups: vec3u) -> u32 {
    return group_id.y * groups.x + group_id.x;
}
