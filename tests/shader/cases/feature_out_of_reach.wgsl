enable wgpu_ray_query;
var scene: acceleration_structure;
@fragment fn main() {}
