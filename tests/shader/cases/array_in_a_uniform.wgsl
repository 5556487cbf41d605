struct Kernel { count: u32, weights: array<f32, 9> }
var<uniform> kernel: Kernel;
@fragment fn main() -> @location(0) f32 { return kernel.weights[3]; }
