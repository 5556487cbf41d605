struct Options { enabled: bool }
struct Item { position: vec3<f32>, options: Options }
var<storage> items: array<Item>;
@fragment fn main() -> @location(0) vec3<f32> { return items[0].position; }
