// Colours by what was found.
struct Found {
    count: u32,
    items: array<u32>,
}
var<storage> found: Found;

@fragment
fn main(@location(0) uv: vec2f) -> @location(0) vec4f {
    return vec4f(f32(found.count), uv, 1.0);
}
