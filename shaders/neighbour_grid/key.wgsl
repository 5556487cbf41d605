// The cell of each particle, as the key to sort by.
#import "lib/cells.wgsl"
#import "lib/dispatch.wgsl"
#import "lib/packed.wgsl"

struct Params {
    particles_count: u32,
    particles_min: vec3f,
    cell_size: f32,
    columns: u32,
    rows: u32,
    slices: u32,
}

var<uniform> params: Params;
var<storage, read> particles_position: array<Packed3>;
var<storage, read_write> keys: array<u32>;

@compute @workgroup_size(256)
fn key(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_index(id, groups, 256u);
    if i >= params.particles_count {
        return;
    }
    let cell = cell_of(unpack3(particles_position[i]), params.particles_min, params.cell_size);
    keys[i] = cell_key(cell, vec3u(params.columns, params.rows, params.slices));
}
