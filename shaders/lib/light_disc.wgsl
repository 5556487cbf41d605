// A surfel's disc as the light sees it on the virtual screen.
#import "lib/light_screen.wgsl"
#import "lib/surfel.wgsl"

struct Disc {
    @builtin(position) clip: vec4f,
    @location(0) side: vec2f,
    @location(1) path_m: f32,
    @location(2) @interpolate(flat) normal: vec3f,
}

/// The disc's corner, its depth moved away from the light by `behind_m`; nothing where it faces away from the light.
fn disc_on_screen(surfel: Surfel, corner: u32, behind_m: f32) -> Disc {
    let side = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    let n = surfel.normal;
    let other = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(n.x) > 0.7);
    let u = normalize(cross(other, n));
    let p = surfel.position + surfel.radius * (side.x * u + side.y * cross(n, u));
    let uv = screen_uv(p);
    let path = screen_path(p);
    // Reversed depth: 1 well above the screen, 0 well below the ground.
    let far = 2.0 * screen_path(vec3f(0.0, light_screen.bottom_m, 0.0));
    let depth = 0.75 - 0.75 * (path + behind_m) / far;
    var clip = vec4f(uv.x * 2.0 - 1.0, 1.0 - 2.0 * uv.y, clamp(depth, 0.0, 1.0), 1.0);
    if !sun_shines() || dot(n, sun.direction) >= 0.0 {
        clip = vec4f(2.0, 2.0, 0.5, 1.0);
    }
    return Disc(clip, side, path, n);
}
