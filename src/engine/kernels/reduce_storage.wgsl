// As reduce.wgsl, for what cannot be a target. DIMENSION is 2d or 3d, SCALAR f32, i32 or u32,
// FORMAT a storage format.
@group(0) @binding(0) var above: texture_DIMENSION<SCALAR>;
@group(0) @binding(1) var reduced: texture_storage_DIMENSION<FORMAT, write>;

fn extent_above() -> vec3<f32> {
    return vec3<f32>(EXTENT_ABOVE);
}

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = extent_above();
    let extent = max(floor(size * 0.5), vec3<f32>(1.0));
    if any(vec3<f32>(id) >= extent) {
        return;
    }
    let covered = size / extent;
    let first = vec3<f32>(id) * covered;
    let last = min(first + covered, size);
    var sum = vec4<f32>(0.0);
    for (var z = floor(first.z); z < last.z; z += 1.0) {
        for (var y = floor(first.y); y < last.y; y += 1.0) {
            for (var x = floor(first.x); x < last.x; x += 1.0) {
                let at = vec3<f32>(x, y, z);
                let weight = max(min(last, at + 1.0) - max(first, at), vec3<f32>(0.0));
                sum += weight.x * weight.y * weight.z * vec4<f32>(textureLoad(above, vec3<u32>(at).SWIZZLE, 0));
            }
        }
    }
    let span = last - first;
    textureStore(reduced, id.SWIZZLE, vec4<SCALAR>(sum / (span.x * span.y * span.z)));
}
