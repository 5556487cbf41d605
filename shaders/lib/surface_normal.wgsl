// Normal of a depth layer from its own depth (Imai 2016, end of section 4.3).
#import "lib/camera.wgsl"

/// Change of the eye-space point over one pixel along `step`: the mean of both sides, or one side where the other has
/// no surface or jumps by more than `gap_m`; 0 if there is none.
fn tangent(layer_z: texture_2d_array<f32>, texel: vec2i, layer: u32, z: f32, step: vec2i, gap_m: f32) -> vec3f {
    let size = vec2i(textureDimensions(layer_z));
    let p = eye_from_pixel(vec2f(texel) + 0.5, z);
    var sum = vec3f(0.0);
    var best = vec3f(0.0);
    var best_jump = 1.0e30;
    var sides = 0.0;
    for (var side = -1; side <= 1; side += 2) {
        let at = texel + side * step;
        if any(at < vec2i(0)) || any(at >= size) {
            continue;
        }
        let z_side = textureLoad(layer_z, at, layer, 0).x;
        if z_side == 0.0 {
            continue;
        }
        let change = f32(side) * (eye_from_pixel(vec2f(at) + 0.5, z_side) - p);
        let jump = abs(z_side - z);
        if jump < gap_m {
            sum += change;
            sides += 1.0;
        }
        if jump < best_jump {
            best = change;
            best_jump = jump;
        }
    }
    if sides > 0.0 {
        return sum / sides;
    }
    return best;
}

/// Unit normal towards the viewer at layer 0 and away from him at layer 1; `fallback` where the pixel stands alone.
fn surface_normal(layer_z: texture_2d_array<f32>, texel: vec2i, layer: u32, z: f32, gap_m: f32, fallback: vec3f) -> vec3f {
    let right = tangent(layer_z, texel, layer, z, vec2i(1, 0), gap_m);
    let up = tangent(layer_z, texel, layer, z, vec2i(0, -1), gap_m);
    let crossed = cross(right, up);
    let length_2 = dot(crossed, crossed);
    if length_2 == 0.0 {
        return fallback;
    }
    let towards = crossed * inverseSqrt(length_2);
    return select(towards, -towards, layer == 1u);
}
