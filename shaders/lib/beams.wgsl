// Refracted beams from the pixels of the virtual screen, and where they meet a level plane (Iwasaki et al. 2006, section 5.1).
#import "lib/light_screen.wgsl"
#import "lib/optics.wgsl"

struct Beams {
    absorption: vec3f,
    // Colour: 0 to 2.
    layer: u32,
}

var<uniform> beams_of: Beams;
var beam_start: texture_2d<f32>;
var beam_along: texture_2d_array<f32>;

/// Where a beam meets the plane, in x and z, and what is left of its light.
struct Hit {
    at: vec2f,
    left: vec3f,
}

fn hit(pixel: vec2u, height: f32) -> Hit {
    let start = textureLoad(beam_start, pixel, 0);
    let along = textureLoad(beam_along, pixel, beams_of.layer, 0);
    let above = height > start.y;
    // Above the water the light has not been refracted yet.
    let direction = select(along.xyz, sun.direction, above);
    let path = (height - start.y) / min(direction.y, -1.0e-3);
    let wet_path = select(path, 0.0, above || along.w == 0.0);
    let transmittance = select(start.w, sign(start.w), above);
    return Hit(start.xz + path * direction.xz, transmittance * transmitted(beams_of.absorption, wet_path));
}

/// The same as if there were no water.
fn straight_hit(pixel: vec2u, height: f32) -> Hit {
    let start = textureLoad(beam_start, pixel, 0);
    let path = (height - start.y) / min(sun.direction.y, -1.0e-3);
    return Hit(start.xz + path * sun.direction.xz, vec3f(sign(start.w)));
}

/// Whether a beam goes through water.
fn is_wet(pixel: vec2u) -> bool {
    return textureLoad(beam_along, pixel, 1, 0).w > 0.0;
}
