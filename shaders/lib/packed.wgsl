// Vectors of 12 bytes, as particle files give them: an array<vec3f> would take 16 bytes an item.

struct Packed3 {
    x: f32,
    y: f32,
    z: f32,
}

fn unpack3(packed: Packed3) -> vec3f {
    return vec3f(packed.x, packed.y, packed.z);
}
