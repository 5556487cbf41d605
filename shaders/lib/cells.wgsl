// Numbering of the neighbour grid's cells: x runs fastest, and a count of cells smaller than the domain wraps around.

/// The cell of a point, counted from 1 so that the cells around it have numbers from 0.
fn cell_of(p: vec3f, low: vec3f, cell_size: f32) -> vec3u {
    // A point far out must not leave the range of u32 when one is added.
    return vec3u(clamp(floor((p - low) / cell_size), vec3f(0.0), vec3f(2.0e9))) + 1u;
}

fn cell_key(cell: vec3u, cells: vec3u) -> u32 {
    let wrapped = cell % cells;
    return (wrapped.z * cells.y + wrapped.y) * cells.x + wrapped.x;
}
