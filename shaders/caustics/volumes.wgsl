// Illumination volumes cut by a sample plane: three neighbouring beams give a triangle, in which their flux is spread
// (Iwasaki et al. 2006, section 5.1 and equation 2 without the receiver).
#import "lib/light_screen.wgsl"
#import "lib/optics.wgsl"

struct Params {
    plane: u32,
    planes: u32,
    absorption: vec3f,
    layer: u32,
    plane_px: u32,
}

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) irradiance: vec3f,
}

/// A triangle with a smaller standard deviation than this, in texels, is widened if its light is concentrated: slivers fall
/// between the pixels or glare on one. Others meet as many pixels as their light needs, and tile the plane seamlessly.
const NARROWEST = 0.35;
const CONCENTRATED = 4.0;

var<uniform> params: Params;
var beam_start: texture_2d<f32>;
var beam_along: texture_2d_array<f32>;

/// Where a beam meets the plane, in x and z, and what is left of its light.
struct Hit {
    at: vec2f,
    left: vec3f,
}

fn hit(pixel: vec2u, height: f32) -> Hit {
    let start = textureLoad(beam_start, pixel, 0);
    let along = textureLoad(beam_along, pixel, params.layer, 0);
    let above = height > start.y;
    // Above the water the light has not been refracted yet.
    let direction = select(along.xyz, sun.direction, above);
    let path = (height - start.y) / min(direction.y, -1.0e-3);
    let wet_path = select(path, 0.0, above || along.w == 0.0);
    let transmittance = select(start.w, sign(start.w), above);
    return Hit(start.xz + path * direction.xz, transmittance * transmitted(params.absorption, wet_path));
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    let size = textureDimensions(beam_start);
    let cell = index / 6u;
    let first = vec2u(cell % (size.x - 1u), cell / (size.x - 1u));
    let upper = (index % 6u) >= 3u;
    let height = mix(light_screen.top_m, light_screen.bottom_m, f32(params.plane) / f32(params.planes - 1u));
    let hits = array<Hit, 3>(
        hit(first + select(vec2u(0u), vec2u(1u), upper), height),
        hit(first + vec2u(1u, 0u), height),
        hit(first + vec2u(0u, 1u), height),
    );
    // All in parts of the plane, from 0 to 1.
    let region = light_screen.region_max - light_screen.region_min;
    let a = (hits[0].at - light_screen.region_min) / region;
    let b = (hits[1].at - light_screen.region_min) / region;
    let c = (hits[2].at - light_screen.region_min) / region;

    let corners = screen_corners();
    let cell_m = (corners.zw - corners.xy) / light_screen.screen_px;
    // Flux through half a pixel of the screen, as a share of the plane's area: equation 2's cosine and F_q in one.
    let flux = irradiance(sun) * max(-sun.direction.y, 0.0) * 0.5 * cell_m.x * cell_m.y / (region.x * region.y);
    let area = 0.5 * abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));

    // Second moments of the triangle, in texels: what stands for it has the same or more.
    let texels = vec2f(f32(params.plane_px));
    let ab = (b - a) * texels;
    let bc = (c - b) * texels;
    let ca = (a - c) * texels;
    let xx = (ab.x * ab.x + bc.x * bc.x + ca.x * ca.x) / 36.0;
    let yy = (ab.y * ab.y + bc.y * bc.y + ca.y * ca.y) / 36.0;
    let xy = (ab.x * ab.y + bc.x * bc.y + ca.x * ca.y) / 36.0;
    let half_trace = 0.5 * (xx + yy);
    let root = sqrt(max(0.25 * (xx - yy) * (xx - yy) + xy * xy, 0.0));
    let wide = sqrt(half_trace + root);
    let narrow = sqrt(max(half_trace - root, 0.0));

    let k = index % 3u;
    var out: Corner;
    var at = vec2f(0.0);
    let before = 0.5 * cell_m.x * cell_m.y / (region.x * region.y);
    if narrow >= NARROWEST || CONCENTRATED * area >= before {
        at = select(select(c, b, k == 1u), a, k == 0u);
        let left = select(select(hits[2].left, hits[1].left, k == 1u), hits[0].left, k == 0u);
        out.irradiance = flux * left / area;
    } else {
        // A triangle with moments 1 in both directions, stretched: its corners lie sqrt(8) from its middle.
        let deviations = max(vec2f(wide, narrow), vec2f(NARROWEST));
        var axis = vec2f(xy, half_trace + root - xx);
        if abs(axis.x) + abs(axis.y) < 1.0e-12 {
            axis = select(vec2f(0.0, 1.0), vec2f(1.0, 0.0), xx >= yy);
        }
        axis = normalize(axis);
        let turn = f32(k) * 2.0943951;
        let side = 2.8284271 * vec2f(cos(turn), sin(turn)) * deviations;
        at = (a + b + c) / 3.0 + (side.x * axis + side.y * vec2f(-axis.y, axis.x)) / texels;
        let left = (hits[0].left + hits[1].left + hits[2].left) / 3.0;
        out.irradiance = flux * left * texels.x * texels.y / (10.3923048 * deviations.x * deviations.y);
    }
    out.clip = vec4f(at.x * 2.0 - 1.0, 1.0 - 2.0 * at.y, 0.5, 1.0);
    if !sun_shines() {
        out.clip = vec4f(2.0, 2.0, 0.5, 1.0);
    }
    return out;
}

@fragment
fn add(in: Corner) -> @location(0) vec4f {
    return vec4f(in.irradiance, 1.0);
}
