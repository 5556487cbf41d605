struct Items { items: array<f32>, count: u32 }
var<storage> items: Items;
@fragment fn main() -> @location(0) f32 { return items.items[0]; }
