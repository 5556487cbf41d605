// Colours by the numbers of a buffer.
var<storage> numbers: array<u32>;

@fragment
fn main(@builtin(position) at: vec4f) -> @location(0) vec4f {
    return vec4f(f32(numbers[u32(at.x)]), 0.0, 0.0, 1.0);
}
