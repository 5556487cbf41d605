struct Params { scale: f32, enabled: bool }
var<uniform> params: Params;
@fragment fn main() -> @location(0) f32 { return params.scale; }
