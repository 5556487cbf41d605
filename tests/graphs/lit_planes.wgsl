// A height field as the light meets it: normal, and metres of light from the virtual screen.
#import "lib/light_screen.wgsl"

struct Params {
    shape: u32,
    level_m: f32,
    height_m: f32,
    length_m: f32,
}

const BUMP = 1u;
const WAVE = 2u;
const TAU = 6.28318531;

var<uniform> params: Params;
var surface: texture_storage_2d<rgba32float, write>;

/// Height above the level, and its slopes along x and z.
fn height(at: vec2f) -> vec3f {
    let k = TAU / params.length_m;
    if params.shape == WAVE {
        return params.height_m * vec3f(cos(k * at.x), -k * sin(k * at.x), 0.0);
    }
    if params.shape == BUMP {
        // Waves in two directions that fade to nothing 0.35 m from the middle.
        let away = at - 0.5;
        let inner = max(1.0 - dot(away, away) / (0.35 * 0.35), 0.0);
        let fade = inner * inner;
        let fade_slope = -4.0 * inner * away / (0.35 * 0.35);
        let waves = sin(k * at.x) * cos(k * at.y);
        let slopes = k * vec2f(cos(k * at.x) * cos(k * at.y), -sin(k * at.x) * sin(k * at.y));
        return params.height_m * vec3f(fade * waves, fade * slopes + fade_slope * waves);
    }
    return vec3f(0.0);
}

@compute @workgroup_size(8, 8)
fn fill(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(surface)) {
        return;
    }
    let uv = (vec2f(id.xy) + 0.5) / light_screen.screen_px;
    // Where a slanted ray meets the waves, by fixed-point steps.
    var path = screen_path(vec3f(0.0, params.level_m, 0.0));
    for (var k = 0; k < 32; k++) {
        let p = screen_point(uv, path);
        path = screen_path(vec3f(0.0, params.level_m + height(p.xz).x, 0.0));
    }
    let slopes = height(screen_point(uv, path).xz).yz;
    textureStore(surface, id.xy, vec4f(normalize(vec3f(-slopes.x, 1.0, -slopes.y)), path));
}
