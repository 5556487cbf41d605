// One step of the wave equation, h'' = c^2 (d2h/dx2 + d2h/dz2), by symplectic Euler on square cells: speeds first, from
// the heights as they are, then heights. What it keeps is half v^2 + half c^2 grad h(now) . grad h(before), so that
// waves neither grow nor fade by themselves. The walls reflect: beyond them lies what lies before them.
#import "ripples/ball.wgsl"
#import "ripples/surface.wgsl"

struct Params {
    time: f32,
    delta: f32,
    cell_m: f32,
    speed: f32,
    damping: f32,
    ball_m: f32,
    wake: f32,
    push: f32,
    push_m: f32,
    pointer_origin: vec3f,
    pointer_direction: vec3f,
    pointer_pressed: u32,
}

var<uniform> params: Params;
var surface_next: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(8, 8)
fn step_surface(@builtin(global_invocation_id) id: vec3u) {
    let size = vec2i(textureDimensions(surface));
    let texel = vec2i(id.xy);
    if any(texel >= size) {
        return;
    }
    let last = size - 1;
    let old = textureLoad(surface, texel, 0).xy;
    let around = height(texel + vec2i(1, 0), last) + height(texel - vec2i(1, 0), last)
        + height(texel + vec2i(0, 1), last) + height(texel - vec2i(0, 1), last);
    let per_cell = params.speed / params.cell_m;
    var v = old.y + params.delta * per_cell * per_cell * (around - 4.0 * old.x);
    v /= 1.0 + params.damping * params.delta;
    let extent = vec2f(size) * params.cell_m;
    let at = (vec2f(texel) + 0.5) * params.cell_m - 0.5 * extent;
    v += params.delta * pointed_at(at);
    let h = old.x + params.delta * v + carried_by_ball(at, extent);
    textureStore(surface_next, texel, vec4f(h, v, 0.0, 0.0));
}

/// What the ball's way in this step moves: as much water rises where it left as sinks where it came.
fn carried_by_ball(at: vec2f, extent: vec2f) -> f32 {
    let before = ball_at(params.time - params.delta, extent, params.ball_m);
    let now = ball_at(params.time, extent, params.ball_m);
    return params.wake * (pressed_by_ball(at, before, params.ball_m) - pressed_by_ball(at, now, params.ball_m));
}

/// Acceleration under the pointer while it is pressed: down in the middle, up around, in all none.
fn pointed_at(at: vec2f) -> f32 {
    if params.pointer_pressed == 0u || params.pointer_direction.y > -1.0e-3 {
        return 0.0;
    }
    let way = -params.pointer_origin.y / params.pointer_direction.y;
    let away = at - (params.pointer_origin + way * params.pointer_direction).xz;
    let s = dot(away, away) / (params.push_m * params.push_m);
    // Pressed for a tenth of a second it reaches the full speed.
    return -10.0 * params.push * (1.0 - s) * exp(-s);
}
