// Runs of the particles around a point in a neighbour grid that the graph calls `grid`.
#import "lib/cells.wgsl"
#import "lib/sorted.wgsl"

struct Grid {
    particles_min: vec3f,
    grid_cell_size: f32,
    grid_columns: u32,
    grid_rows: u32,
    grid_slices: u32,
}

var<uniform> grid: Grid;
var<storage, read> grid_cell_start: array<u32>;
var<storage, read> grid_sorted: array<Sorted>;

/// Nine rows of three cells each; a row that wraps around falls into two runs.
const RUNS = 18u;

/// Run 0 to 17 of `grid_sorted` around a cell, as first and end; often empty.
fn run_around(cell: vec3u, run: u32) -> vec2u {
    let row = run >> 1u;
    let size = vec3u(grid.grid_columns, grid.grid_rows, grid.grid_slices);
    // The cell's numbers start at 1, so none of these falls below 0.
    let at = (cell + vec3u(0u, row % 3u, row / 3u) - 1u) % size;
    let base = (at.z * size.y + at.y) * size.x;
    let over = max(at.x + 3u, size.x) - size.x;
    if (run & 1u) == 1u {
        if over == 0u {
            return vec2u(0u);
        }
        return vec2u(grid_cell_start[base], grid_cell_start[base + over]);
    }
    return vec2u(grid_cell_start[base + at.x], grid_cell_start[base + min(at.x + 3u, size.x)]);
}

fn grid_cell(p: vec3f) -> vec3u {
    return cell_of(p, grid.particles_min, grid.grid_cell_size);
}

/// Every how many-th particle of each run is looked at: particles heaped beyond reason are sampled evenly, so that the
/// time stays bounded.
fn stride_around(cell: vec3u, candidates_max: u32) -> u32 {
    var candidates = 0u;
    for (var k = 0u; k < RUNS; k++) {
        let run = run_around(cell, k);
        candidates += run.y - run.x;
    }
    return 1u + candidates / candidates_max;
}
