// The bracket of equation 1 by distance, as the paper's texture: texel i holds a = i / (texels - 1).
#import "lib/kernel.wgsl"

@fragment
fn lookup(@builtin(position) position: vec4f) -> @location(0) f32 {
    let a = floor(position.x) / 1023.0;
    return bracket(a * a);
}
