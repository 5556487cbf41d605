// From squared distances and winding numbers to signed distances.

struct Params {
    columns: u32,
    rows: u32,
}

var<uniform> params: Params;
var<storage, read> nearest: array<f32>;
var<storage, read> winding: array<f32>;
var distance: texture_storage_3d<r32float, write>;

@compute @workgroup_size(4, 4, 4)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= textureDimensions(distance)) {
        return;
    }
    let cell = (id.z * params.rows + id.y) * params.columns + id.x;
    // A mesh that is turned inside out winds the other way round.
    let side = select(1.0, -1.0, abs(winding[cell]) > 0.5);
    textureStore(distance, id, vec4f(side * sqrt(nearest[cell])));
}
