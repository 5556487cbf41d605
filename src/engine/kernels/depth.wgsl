// Depth as a colour, for formats whose depth cannot be copied to a buffer.
@group(0) @binding(0) var depth: texture_depth_2d;

@fragment
fn depth_as_color(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(textureLoad(depth, vec2<u32>(position.xy), 0), 0.0, 0.0, 1.0);
}
