// Empties a tile for the slab that comes next.

@fragment
fn empty() -> @location(0) vec4f {
    return vec4f(0.0);
}
