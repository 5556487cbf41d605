// Where a liquid rests on a floor or leans against walls, it goes on behind them as if mirrored: else its density would
// fall off there and its surface would bend down. Not in the paper (Iwasaki et al. 2006), whose pool leaves it open.

struct Mirrors {
    // The box in which the particles lie, with their radius.
    rest_min: vec3f,
    rest_max: vec3f,
    rests: u32,
    // Height of the walls above the box's lowest corner.
    walls_m: f32,
    // Particles that are further than this from floor and walls need no image.
    mirrored_m: f32,
}

var<uniform> mirrors: Mirrors;

/// Far enough for a density of 0.
const NO_IMAGE = 1.0e6;

/// The mirror images of a place's coordinates, each at the nearer wall or at the floor; `NO_IMAGE` where there is none.
fn mirrored(p: vec3f) -> vec3f {
    let to_low = p - mirrors.rest_min;
    let to_high = mirrors.rest_max - p;
    let is_low = to_low <= to_high;
    let leans = mirrors.rests != 0u && to_low.y < mirrors.walls_m;
    let in_mirror = vec3<bool>(leans, mirrors.rests != 0u && is_low.y, leans);
    let image = select(2.0 * mirrors.rest_max, 2.0 * mirrors.rest_min, is_low) - p;
    let is_near = min(to_low, to_high) < vec3f(mirrors.mirrored_m);
    return select(vec3f(NO_IMAGE), image, in_mirror & is_near);
}

/// Whether a place is not so far behind floor and walls that nobody sees what is there.
fn before_mirrors(p: vec3f, behind_m: f32) -> bool {
    let leans = mirrors.rests != 0u && p.y - mirrors.rest_min.y < mirrors.walls_m;
    let low = p >= mirrors.rest_min - behind_m;
    let high = p <= mirrors.rest_max + behind_m;
    return (low.y || mirrors.rests == 0u) && (!leans || (low.x && low.z && high.x && high.z));
}
