// Eye z of the nearest of a pixel's four samples; 0 where nothing is. WebGPU resolves no depth by itself.
#import "lib/camera.wgsl"

var depth_ms: texture_depth_multisampled_2d;

@fragment
fn nearest_z(@builtin(position) position: vec4f) -> @location(0) f32 {
    let texel = vec2i(position.xy);
    var depth = 0.0;
    for (var k = 0; k < 4; k++) {
        depth = max(depth, textureLoad(depth_ms, texel, k));
    }
    if depth == 0.0 {
        return 0.0;
    }
    return eye_z_from_depth(depth);
}
