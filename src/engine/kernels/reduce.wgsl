// One mip from the one above it: the mean over the area that a texel covers, so that the mean of
// the whole stays, also where a size is odd. SCALAR is f32, i32 or u32.
@group(0) @binding(0) var above: texture_2d<SCALAR>;

@fragment
fn reduce(@builtin(position) position: vec4<f32>) -> @location(0) vec4<SCALAR> {
    let size = vec2<f32>(textureDimensions(above));
    let covered = size / max(floor(size * 0.5), vec2<f32>(1.0));
    let first = floor(position.xy) * covered;
    let last = min(first + covered, size);
    var sum = vec4<f32>(0.0);
    for (var y = floor(first.y); y < last.y; y += 1.0) {
        for (var x = floor(first.x); x < last.x; x += 1.0) {
            let at = vec2<f32>(x, y);
            let weight = max(min(last, at + 1.0) - max(first, at), vec2<f32>(0.0));
            sum += weight.x * weight.y * vec4<f32>(textureLoad(above, vec2<u32>(at), 0));
        }
    }
    let area = (last.x - first.x) * (last.y - first.y);
    return vec4<SCALAR>(sum / area);
}
