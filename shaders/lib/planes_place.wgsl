// Where the sample planes of `parts/caustics.ron` lie: a rectangle in x and z, and the heights of the first and the last.

struct PlanesPlace {
    region_min: vec2f,
    region_max: vec2f,
    top_m: f32,
    bottom_m: f32,
}
