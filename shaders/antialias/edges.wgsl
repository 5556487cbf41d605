// Softens the stairs of silhouettes after the fact (after Timothy Lottes's FXAA, its short form of 2010).

struct Params {
    antialias: u32,
}

/// Contrast below which nothing is done, as a share of the brightest neighbour; and the longest blur. Both by eye.
const CONTRAST = 0.12;
const LONGEST_PX = 8.0;

var<uniform> params: Params;
var raw: texture_2d<f32>;
var linear_clamp: sampler;

/// Brightness as a picture shows it, so that the sun's disc does not outweigh everything.
fn shown(color: vec4f) -> f32 {
    let light = dot(color.rgb, vec3f(0.3, 0.59, 0.11)) + 0.2 * (1.0 - color.a);
    return sqrt(light / (1.0 + light));
}

fn at(uv: vec2f) -> vec4f {
    return textureSampleLevel(raw, linear_clamp, uv, 0.0);
}

@fragment
fn soften(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = 1.0 / vec2f(textureDimensions(raw));
    let uv = position.xy * texel;
    let middle = textureLoad(raw, vec2i(position.xy), 0);
    if params.antialias == 0u {
        return middle;
    }
    let nw = shown(at(uv + vec2f(-0.5, -0.5) * texel));
    let ne = shown(at(uv + vec2f(0.5, -0.5) * texel));
    let sw = shown(at(uv + vec2f(-0.5, 0.5) * texel));
    let se = shown(at(uv + vec2f(0.5, 0.5) * texel));
    let m = shown(middle);
    let low = min(m, min(min(nw, ne), min(sw, se)));
    let high = max(m, max(max(nw, ne), max(sw, se)));
    if high - low < CONTRAST * high {
        return middle;
    }
    // Along the edge, at right angles to the gradient.
    var along = vec2f((sw + se) - (nw + ne), (nw + sw) - (ne + se));
    let shortest = min(abs(along.x), abs(along.y)) + max(0.03125 * (nw + ne + sw + se), 1.0e-4);
    along = clamp(along / shortest, vec2f(-LONGEST_PX), vec2f(LONGEST_PX)) * texel;
    let inner = 0.5 * (at(uv - along / 6.0) + at(uv + along / 6.0));
    let outer = 0.5 * inner + 0.25 * (at(uv - along / 2.0) + at(uv + along / 2.0));
    let brightness = shown(outer);
    return select(outer, inner, brightness < low || brightness > high);
}
