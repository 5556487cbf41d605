// A particle in the order of the neighbour grid's cells: its position and its number in the file.

struct Sorted {
    x: f32,
    y: f32,
    z: f32,
    particle: u32,
}

fn sorted_position(item: Sorted) -> vec3f {
    return vec3f(item.x, item.y, item.z);
}
