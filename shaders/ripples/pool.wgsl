// The pool as seen through its surface: reflected sky, refracted tiles and ball, the deck around. World space, metres;
// the still surface is at y = 0, the pool's middle at the origin.
#import "lib/camera.wgsl"
#import "lib/harmonics.wgsl"
#import "lib/light.wgsl"
#import "lib/optics.wgsl"
#import "ripples/ball.wgsl"

struct Params {
    time: f32,
    pool: vec3f,
    wide_m: f32,
    ball_m: f32,
    ior: f32,
    absorption: vec3f,
    rim_m: f32,
    deck_m: f32,
    tile_m: f32,
    camera_pixel_m: f32,
}

struct Hit {
    way: f32,
    normal: vec3f,
    kind: u32,
}

const NOTHING = 0u;
const FLOOR = 1u;
const WALL = 2u;
const BALL = 3u;
const FAR = 1.0e9;
const PI = 3.14159265;

var<uniform> params: Params;
var<uniform> sun: Light;
var sky_cube: texture_cube<f32>;
var<storage, read> sky_ambient: array<vec4f>;
var relief: texture_2d<f32>;
var light: texture_2d<f32>;
var linear_clamp: sampler;

fn half_extent() -> vec2f {
    return 0.5 * vec2f(params.pool.x, params.wide_m);
}

/// Height, slopes and curvature of the surface at a place.
fn surface_at(at: vec2f) -> vec4f {
    return textureSampleLevel(relief, linear_clamp, at / (2.0 * half_extent()) + 0.5, 0.0);
}

fn ambient_on(normal: vec3f) -> vec3f {
    let basis = harmonics(normal);
    var sum = vec3f(0.0);
    for (var k = 0u; k < 9u; k++) {
        sum += sky_ambient[k].rgb * basis[k];
    }
    return max(sum, vec3f(0.0));
}

/// Way to the ball from outside it.
fn to_ball(origin: vec3f, direction: vec3f) -> f32 {
    let centre = ball_at(params.time, 2.0 * half_extent(), params.ball_m);
    let from_centre = origin - centre;
    let b = dot(from_centre, direction);
    let c = dot(from_centre, from_centre) - params.ball_m * params.ball_m;
    let root = b * b - c;
    if params.ball_m == 0.0 || root < 0.0 || -b - sqrt(root) < 0.0 {
        return FAR;
    }
    return -b - sqrt(root);
}

/// The nearest of floor, walls and ball from a point inside the pool's box.
fn inside_pool(origin: vec3f, direction: vec3f) -> Hit {
    let half = half_extent();
    var hit = Hit(FAR, vec3f(0.0, 1.0, 0.0), NOTHING);
    if direction.y < 0.0 {
        hit = Hit((-params.pool.y - origin.y) / direction.y, vec3f(0.0, 1.0, 0.0), FLOOR);
    }
    let way = (select(-half, half, direction.xz > vec2f(0.0)) - origin.xz) / direction.xz;
    if direction.x != 0.0 && way.x < hit.way {
        hit = Hit(max(way.x, 0.0), vec3f(-sign(direction.x), 0.0, 0.0), WALL);
    }
    if direction.z != 0.0 && way.y < hit.way {
        hit = Hit(max(way.y, 0.0), vec3f(0.0, 0.0, -sign(direction.z)), WALL);
    }
    let ball = to_ball(origin, direction);
    if ball < hit.way {
        let centre = ball_at(params.time, 2.0 * half, params.ball_m);
        hit = Hit(ball, normalize(origin + ball * direction - centre), BALL);
    }
    return hit;
}

/// Share of a tile that is no grout, averaged over a footprint in metres; a number for each tile.
struct Tile {
    face: f32,
    chance: f32,
}

fn chance_of(cell: vec2f) -> f32 {
    return fract(sin(dot(cell, vec2f(12.9898, 78.233))) * 43758.547);
}

fn tile_at(at: vec2f, edge_m: f32, grout_m: f32, footprint_m: f32) -> Tile {
    let from_line = (0.5 - abs(fract(at / edge_m) - 0.5)) * edge_m;
    let soft = max(footprint_m, 1.0e-4);
    let face = clamp((from_line - 0.5 * grout_m) / soft + 0.5, vec2f(0.0), vec2f(1.0));
    // Lines thinner than a pixel darken it by their share.
    let share = vec2f(1.0 - grout_m / edge_m);
    let far = clamp(soft / edge_m * 2.0 - 0.5, 0.0, 1.0);
    let mixed = mix(face, share, far);
    return Tile(mixed.x * mixed.y, mix(chance_of(floor(at / edge_m)), 0.5, far));
}

fn pool_tiles(p: vec3f, normal: vec3f, footprint_m: f32) -> vec3f {
    var at = p.xz;
    if abs(normal.x) > 0.5 {
        at = p.zy;
    } else if abs(normal.z) > 0.5 {
        at = p.xy;
    }
    let tile = tile_at(at, params.tile_m, 0.012, footprint_m);
    var glaze = mix(vec3f(0.32, 0.62, 0.68), vec3f(0.52, 0.80, 0.82), tile.chance);
    // A dark band along the water line.
    if abs(normal.y) < 0.5 && p.y > -0.5 * params.tile_m - 0.01 && p.y < params.rim_m {
        glaze = mix(vec3f(0.06, 0.20, 0.34), vec3f(0.10, 0.28, 0.44), tile.chance);
    }
    return mix(vec3f(0.72, 0.74, 0.70), glaze, tile.face);
}

fn ball_paint(normal: vec3f) -> vec3f {
    // Six gores and a cap, turned a little so that both show.
    let tilted = vec3f(normal.x, 0.8 * normal.y - 0.6 * normal.z, 0.6 * normal.y + 0.8 * normal.z);
    if tilted.y > 0.93 {
        return vec3f(0.85, 0.83, 0.78);
    }
    let gore = floor((atan2(tilted.z, tilted.x) / (2.0 * PI) + 0.5) * 6.0);
    return select(vec3f(0.86, 0.84, 0.80), vec3f(0.82, 0.13, 0.08), (i32(gore) & 1) == 0);
}

/// Share of the sun that reaches a point under water: through the opening, past the ball, gathered by the waves.
fn sun_below(p: vec3f, kind: u32) -> vec3f {
    let still = bend_in(sun.direction, vec3f(0.0, 1.0, 0.0), params.ior).direction;
    let down_m = max(-p.y, 0.0);
    let way = down_m / max(-still.y, 0.05);
    let entered = p - still * way;
    let half = half_extent();
    let edge = min(half.x - abs(entered.x), half.y - abs(entered.z));
    var share = smoothstep(-0.02, 0.02, edge);
    if kind == FLOOR {
        share = textureSampleLevel(light, linear_clamp, p.xz / (2.0 * half) + 0.5, 0.0).x;
    } else {
        // A crest above gathers, a trough spreads.
        let bent = (1.0 - 1.0 / params.ior) * down_m * surface_at(entered.xz).w;
        share *= clamp(1.0 / max(1.0 + bent, 0.25), 0.0, 3.0);
    }
    share *= 1.0 - shade_of_ball(p, -still);
    return irradiance(sun) * share * transmitted(params.absorption, way);
}

/// How much of the sun the ball hides from a point, softly.
fn shade_of_ball(p: vec3f, to_sun: vec3f) -> f32 {
    let centre = ball_at(params.time, 2.0 * half_extent(), params.ball_m);
    let along = dot(centre - p, to_sun);
    let away = length(centre - p - along * to_sun);
    let soft = 0.02 + 0.03 * max(along, 0.0);
    return select(0.0, 1.0 - smoothstep(params.ball_m - soft, params.ball_m + soft, away), along > 0.0 && params.ball_m > 0.0);
}

/// Light from a lit point of floor, wall or ball under water towards where the ray came from.
fn below(origin: vec3f, direction: vec3f, before_m: f32) -> vec3f {
    let hit = inside_pool(origin, direction);
    let p = origin + hit.way * direction;
    let footprint = (before_m + hit.way) * params.camera_pixel_m / max(abs(dot(direction, hit.normal)), 0.15);
    var albedo = ball_paint(hit.normal);
    if hit.kind != BALL {
        albedo = pool_tiles(p, hit.normal, footprint);
    }
    let still = bend_in(sun.direction, vec3f(0.0, 1.0, 0.0), params.ior).direction;
    let direct = sun_below(p, hit.kind) * max(dot(hit.normal, -still), 0.0);
    // Sky light comes from above, and more and more from the tiles around.
    let depth_m = max(-p.y, 0.0);
    let sky = ambient_on(vec3f(0.0, 1.0, 0.0)) * (0.35 + 0.35 * max(hit.normal.y, 0.0)) * transmitted(params.absorption, depth_m);
    let bounced = 0.14 * irradiance(sun) * vec3f(0.55, 0.8, 0.8) * transmitted(params.absorption, 1.5 * depth_m);
    let seen = albedo / PI * (direct + sky + bounced);
    return seen * transmitted(params.absorption, hit.way);
}

/// Light from something dry: rim, deck or the ball above the water.
fn dry(p: vec3f, normal: vec3f, albedo: vec3f) -> vec3f {
    let half = half_extent();
    var direct = irradiance(sun) * max(dot(normal, -sun.direction), 0.0);
    if p.y < params.rim_m - 1.0e-3 {
        // The rim casts a shadow into the opening.
        let way = (params.rim_m - p.y) / max(-sun.direction.y, 0.05);
        let out = abs(p.xz - sun.direction.xz * way) - half;
        direct *= 1.0 - smoothstep(-0.01, 0.01, max(out.x, out.y));
    }
    return albedo / PI * (direct + ambient_on(normal));
}

/// What a ray meets above the water: walls of the opening, the ball, else the sky.
fn above(origin: vec3f, direction: vec3f) -> vec3f {
    let hit = inside_pool(origin, direction);
    let p = origin + hit.way * direction;
    if hit.kind == BALL {
        return dry(p, hit.normal, ball_paint(hit.normal));
    }
    if hit.kind == WALL && p.y < params.rim_m {
        return dry(p, hit.normal, pool_tiles(p, hit.normal, hit.way * params.camera_pixel_m));
    }
    let sky = textureSampleLevel(sky_cube, linear_clamp, direction, 0.0).rgb;
    // The sun's own glint, as wide as small waves spread it.
    let glint = pow(max(dot(direction, -sun.direction), 0.0), 1500.0);
    return sky + irradiance(sun) * 60.0 * glint;
}

/// Way along a ray that goes down to the moving surface.
fn to_surface(origin: vec3f, direction: vec3f) -> f32 {
    var way = -origin.y / direction.y;
    for (var i = 0u; i < 6u; i++) {
        let height = surface_at((origin + way * direction).xz).x;
        way += 0.8 * (height - origin.y - way * direction.y) / direction.y;
    }
    return max(way, 0.0);
}

fn in_the_opening(origin: vec3f, direction: vec3f, before_m: f32) -> vec3f {
    let hit = inside_pool(origin, direction);
    let way = to_surface(origin, direction);
    if hit.way < way {
        let p = origin + hit.way * direction;
        if hit.kind == BALL {
            return dry(p, hit.normal, ball_paint(hit.normal));
        }
        return dry(p, hit.normal, pool_tiles(p, hit.normal, (before_m + hit.way) * params.camera_pixel_m));
    }
    let p = origin + way * direction;
    let here = surface_at(p.xz);
    let normal = normalize(vec3f(-here.y, 1.0, -here.z));
    let into = bend_in(direction, normal, params.ior);
    var mirrored = reflect(direction, normal);
    mirrored.y = max(mirrored.y, 0.01);
    let reflected = above(p, normalize(mirrored));
    return mix(below(p, into.direction, before_m + way), reflected, into.reflectance);
}

/// Stone around the pool.
fn deck(p: vec3f, footprint_m: f32) -> vec3f {
    let out = abs(p.xz) - half_extent();
    let from_rim = max(out.x, out.y);
    let tile = tile_at(p.xz + 0.3, 0.6, 0.012, footprint_m);
    var stone = mix(vec3f(0.30, 0.22, 0.15), vec3f(0.40, 0.30, 0.20), tile.chance);
    if from_rim < 0.16 {
        let coping = tile_at(vec2f(select(p.x, p.z, out.x > out.y), from_rim + 0.16), 0.4, 0.01, footprint_m);
        stone = vec3f(0.62, 0.58, 0.50) * mix(0.65, 1.0, coping.face);
    } else {
        stone *= mix(0.6, 1.0, tile.face);
    }
    return stone;
}

@fragment
fn seen(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let ray = eye_ray(position.xy);
    let direction = normalize(world_from_eye_vector(ray.direction));
    let eye = camera.position + world_from_eye_vector(ray.origin);
    let ball = to_ball(eye, direction);
    var way = FAR;
    if direction.y < -1.0e-4 {
        way = max((params.rim_m - eye.y) / direction.y, 0.0);
    }
    if ball < way {
        let p = eye + ball * direction;
        let centre = ball_at(params.time, 2.0 * half_extent(), params.ball_m);
        let normal = normalize(p - centre);
        return vec4f(dry(p, normal, ball_paint(normal)), 1.0);
    }
    if way == FAR {
        return vec4f(0.0);
    }
    let p = eye + way * direction;
    let out = abs(p.xz) - half_extent();
    let from_rim = max(out.x, out.y);
    if from_rim < 0.0 {
        return vec4f(in_the_opening(p, direction, way), 1.0);
    }
    let footprint = way * params.camera_pixel_m / max(-direction.y, 0.1);
    let alpha = 1.0 - smoothstep(params.deck_m - 0.5 * footprint, params.deck_m + 0.5 * footprint, from_rim);
    let shaded = 1.0 - shade_of_ball(p, -sun.direction);
    let light_here = irradiance(sun) * max(-sun.direction.y, 0.0) * shaded + ambient_on(vec3f(0.0, 1.0, 0.0));
    return vec4f(deck(p, footprint) / PI * light_here * alpha, alpha);
}
