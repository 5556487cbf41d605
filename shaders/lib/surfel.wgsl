// A point of a surface: the middle, radius and outward unit normal of a disc, in world space (32 bytes).

struct Surfel {
    position: vec3f,
    radius: f32,
    normal: vec3f,
}

struct Surfels {
    count: u32,
    items: array<Surfel>,
}
