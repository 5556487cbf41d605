// One step of the wave equation on a square of cells: speeds from the heights as they are, then heights.

// Inside `Steps`, `time` and `delta` are those of the step, and so is where the pointer is.
struct Settings {
    time: f32,
    delta: f32,
    cell_m: f32,
    speed: f32,
    damping: f32,
    pointer_origin: vec3f,
    pointer_direction: vec3f,
    pointer_pressed: u32,
}

var<uniform> settings: Settings;
// Height in metres and vertical speed in metres a second.
var sheet: texture_2d<f32>;
var sheet_next: texture_storage_2d<rg32float, write>;

fn height(texel: vec2i) -> f32 {
    // The rim reflects: beyond it lies what lies before it.
    return textureLoad(sheet, clamp(texel, vec2i(0), vec2i(textureDimensions(sheet)) - 1), 0).x;
}

@compute @workgroup_size(8, 8)
fn step_sheet(@builtin(global_invocation_id) id: vec3u) {
    let texel = vec2i(id.xy);
    let size = vec2i(textureDimensions(sheet));
    if any(texel >= size) {
        return;
    }
    let old = textureLoad(sheet, texel, 0).xy;
    let around = height(texel + vec2i(1, 0)) + height(texel - vec2i(1, 0)) + height(texel + vec2i(0, 1)) + height(texel - vec2i(0, 1));
    let per_cell = settings.speed / settings.cell_m;
    var v = old.y + settings.delta * per_cell * per_cell * (around - 4.0 * old.x);
    v /= 1.0 + settings.damping * settings.delta;
    v += settings.delta * pressed((vec2f(texel) + 0.5) * settings.cell_m - 1.0);
    textureStore(sheet_next, texel, vec4f(old.x + settings.delta * v, v, 0.0, 0.0));
}

/// Acceleration at a place: by a drop each 0.8 seconds, each somewhere else, and by the pointer.
fn pressed(at: vec2f) -> f32 {
    let drop = floor(settings.time / 0.8);
    let place = 1.4 * fract(vec2f(0.755, 0.57) * (drop + 1.0)) - 0.7;
    let falls = settings.time - 0.8 * drop < 0.05;
    var push = select(0.0, dent(at - place), falls);
    if settings.pointer_pressed != 0u && settings.pointer_direction.y < -0.001 {
        let way = -settings.pointer_origin.y / settings.pointer_direction.y;
        push += dent(at - (settings.pointer_origin + way * settings.pointer_direction).xz);
    }
    return push;
}

/// Down in the middle, up around, in all none.
fn dent(away: vec2f) -> f32 {
    let s = dot(away, away) / 0.006;
    return -8.0 * (1.0 - s) * exp(-s);
}
