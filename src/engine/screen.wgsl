// Encodes a linear picture (0 to 1) as a screen wants it, by the sRGB curve (IEC 61966-2-1).
@group(0) @binding(0) var light: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(vec2<u32>(index & 1u, index >> 1u)) * 4.0 - 1.0;
    return vec4<f32>(corner, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let linear = clamp(textureLoad(light, vec2<i32>(at.xy), 0).rgb, vec3<f32>(0.0), vec3<f32>(1.0));
    let low = linear * 12.92;
    let high = 1.055 * pow(linear, vec3<f32>(1.0 / 2.4)) - 0.055;
    return vec4<f32>(select(high, low, linear <= vec3<f32>(0.0031308)), 1.0);
}
