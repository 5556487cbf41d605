// A tiled pool sunk into level ground, or a tiled floor without walls; closed forms for rays and colours.
#import "lib/caustic_planes.wgsl"

struct Pool {
    floor_m: f32,
    pool_min: vec2f,
    pool_max: vec2f,
    // Height of the walls and of the ground around; the floor's height where there are no walls.
    rim_m: f32,
    tile_m: f32,
    tile_color: vec3f,
    ground_color: vec3f,
    ground_m: f32,
}

const NOTHING = 0u;
const TILES = 1u;
const GROUND = 2u;

/// Width of the joints as a share of a tile.
const JOINT = 0.045;

struct PoolHit {
    kind: u32,
    t: f32,
    normal: vec3f,
}

var<uniform> basin: Pool;

fn has_walls() -> bool {
    return basin.rim_m > basin.floor_m;
}

fn in_pool(at: vec2f) -> bool {
    return all(at >= basin.pool_min) && all(at <= basin.pool_max);
}

/// Where a ray first meets pool or ground.
fn pool_hit(p: vec3f, direction: vec3f) -> PoolHit {
    var first = PoolHit(NOTHING, 1.0e30, vec3f(0.0, 1.0, 0.0));
    if direction.y < -1.0e-5 {
        let t = (basin.rim_m - p.y) / direction.y;
        let at = p.xz + t * direction.xz;
        if t >= 0.0 && (!has_walls() || !in_pool(at)) {
            first = PoolHit(GROUND, t, first.normal);
        }
        let t_floor = (basin.floor_m - p.y) / direction.y;
        if has_walls() && t_floor >= 0.0 && t_floor < first.t && in_pool(p.xz + t_floor * direction.xz) {
            first = PoolHit(TILES, t_floor, first.normal);
        }
    }
    if !has_walls() {
        return first;
    }
    for (var axis = 0u; axis < 2u; axis++) {
        let d = select(direction.x, direction.z, axis == 1u);
        let o = select(p.x, p.z, axis == 1u);
        if abs(d) < 1.0e-5 {
            continue;
        }
        // The wall that the ray goes towards is seen from inside.
        let t = (select(basin.pool_min[axis], basin.pool_max[axis], d > 0.0) - o) / d;
        let y = p.y + t * direction.y;
        let along = select(p.z + t * direction.z, p.x + t * direction.x, axis == 1u);
        let other = 1u - axis;
        let within = along >= basin.pool_min[other] && along <= basin.pool_max[other];
        if t >= 0.0 && t < first.t && y >= basin.floor_m && y <= basin.rim_m && within {
            let inward = -sign(d);
            first = PoolHit(TILES, t, select(vec3f(inward, 0.0, 0.0), vec3f(0.0, 0.0, inward), axis == 1u));
        }
    }
    return first;
}

/// Share of joints along one axis, averaged over a footprint in tiles.
fn joints(at: f32, footprint: f32) -> f32 {
    let width = max(footprint, 1.0e-4);
    let low = at - 0.5 * width;
    let high = at + 0.5 * width;
    let below = vec2f(floor(low), floor(high)) * JOINT + min(fract(vec2f(low, high)), vec2f(JOINT));
    return clamp((below.y - below.x) / width, 0.0, 1.0);
}

fn hash(at: vec2f) -> f32 {
    let h = fract(at * vec2f(0.1031, 0.1373));
    let mixed = h + dot(h, h.yx + 33.33);
    return fract((mixed.x + mixed.y) * mixed.x * 7.77);
}

fn tiles(at_m: vec2f, footprint_m: f32, tile_m: f32, color: vec3f, joint_color: vec3f) -> vec3f {
    let at = at_m / tile_m;
    let footprint = footprint_m / tile_m;
    let joint = max(joints(at.x, footprint), joints(at.y, footprint));
    // Tiles differ a little, less so the smaller they are seen.
    let shade = mix(1.0, 0.86 + 0.28 * hash(floor(at) + 57.0), clamp(1.5 - footprint, 0.0, 1.0));
    return mix(color * shade, joint_color, joint);
}

/// Premultiplied radiance of a point of the pool or of the ground, which fades out far away.
fn pool_color(p: vec3f, normal: vec3f, kind: u32, footprint_m: f32) -> vec4f {
    let at = select(select(p.xy, p.zy, abs(normal.x) > 0.5), p.xz, abs(normal.y) > 0.5);
    let is_slab = kind == GROUND && has_walls();
    let size = select(1.0, 3.0, is_slab) * basin.tile_m;
    let color = select(basin.tile_color, basin.ground_color, is_slab);
    let albedo = tiles(at, footprint_m, size, color, select(vec3f(0.62, 0.62, 0.58), 0.5 * color, is_slab));
    var alpha = 1.0;
    if kind == GROUND {
        let middle = 0.5 * (basin.pool_min + basin.pool_max);
        alpha = 1.0 - smoothstep(0.35, 1.0, length(p.xz - middle) / basin.ground_m);
    }
    return vec4f(albedo * lit(p, normal) * alpha, alpha);
}
