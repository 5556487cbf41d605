// One step of the iterative bilateral filter (Imai 2014, as Imai 2016 sections 3.1 and 3.2 describe it), front and back
// at once: the weighted mean of the depths in a window, weights by distance on the screen and by difference in depth.

struct Params {
    spatial_px: f32,
    sigma_m: f32,
}

const TILE = 8u;

/// Edge of the window in pixels; odd.
override window: u32 = 9u;
override margin: u32 = window / 2u;
override span: u32 = TILE + 2u * margin;

var<uniform> params: Params;
var shell_z: texture_2d_array<f32>;
var z_next: texture_storage_2d_array<r32float, write>;

/// Eye z of what a workgroup's windows cover (0: nothing).
var<workgroup> around: array<f32, span * span>;

@compute @workgroup_size(8, 8)
fn filter_depth(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let size = vec2i(textureDimensions(shell_z));
    let layer = id.z;
    let corner = vec2i(group.xy * TILE) - i32(margin);
    for (var k = lane; k < span * span; k += TILE * TILE) {
        let at = corner + vec2i(vec2u(k % span, k / span));
        var value = 0.0;
        if all(at >= vec2i(0)) && all(at < size) {
            value = textureLoad(shell_z, at, layer, 0).x;
        }
        around[k] = value;
    }
    workgroupBarrier();
    let texel = vec2i(id.xy);
    if all(texel < size) {
        var z = around[(local.y + margin) * span + local.x + margin];
        if z != 0.0 {
            z = mean_z(local.xy, z);
        }
        textureStore(z_next, texel, layer, vec4f(z));
    }
}

fn mean_z(local: vec2u, z: f32) -> f32 {
    let range = -1.442695 / (params.sigma_m * params.sigma_m);
    let spatial = -0.7213475 / (params.spatial_px * params.spatial_px);
    var weight = 0.0;
    var offset = 0.0;
    for (var y = 0u; y <= 2u * margin; y++) {
        let row = (local.y + y) * span + local.x;
        for (var x = 0u; x <= 2u * margin; x++) {
            let z_j = around[row + x];
            let away = z_j - z;
            let step = vec2f(vec2u(x, y)) - f32(margin);
            let w = select(exp2(away * away * range + dot(step, step) * spatial), 0.0, z_j == 0.0);
            weight += w;
            offset += w * away;
        }
    }
    return z + offset / weight;
}
