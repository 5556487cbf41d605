// What starts from each pixel of the virtual screen: the point on the water, the refracted direction of each colour,
// and the Fresnel transmittance (Iwasaki et al. 2006, section 5.2 and T of equation 2).
#import "lib/light_screen.wgsl"
#import "lib/optics.wgsl"

struct Params {
    dispersion: f32,
    hole_min: vec2f,
    hole_max: vec2f,
    hole_m: f32,
}

var<uniform> params: Params;
var surface: texture_2d<f32>;
/// Point and transmittance.
var beam_start: texture_storage_2d<rgba32float, write>;
/// Unit direction of red, green and blue; w is 1 in water and 0 where the light goes on through the air.
var beam_along: texture_storage_2d_array<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn refract_sun(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(surface);
    if any(id.xy >= size) {
        return;
    }
    let uv = (vec2f(id.xy) + 0.5) / vec2f(size);
    let water = textureLoad(surface, id.xy, 0);
    let facing = -dot(water.xyz, sun.direction);
    let wet = facing > 0.0;
    let path = select(screen_path(vec3f(0.0, light_screen.bottom_m, 0.0)), water.w, wet);
    let p = screen_point(uv, path);
    // The place where the light comes through the opening.
    let through = p.xz + sun.direction.xz * ((params.hole_m - p.y) / min(sun.direction.y, LOWEST));
    let open = all(through > params.hole_min) && all(through < params.hole_max);
    let transmittance = select(1.0, 1.0 - fresnel(facing, light_screen.ior), wet);
    textureStore(beam_start, id.xy, vec4f(p, select(0.0, transmittance, open && sun_shines())));
    for (var color = 0; color < 3; color++) {
        let ior = max(light_screen.ior + params.dispersion * 0.5 * f32(color - 1), 1.0);
        let direction = select(sun.direction, bend_in(sun.direction, water.xyz, ior).direction, wet);
        textureStore(beam_along, id.xy, color, vec4f(direction, select(0.0, 1.0, wet)));
    }
}
