// The pool's floor, its four walls from inside, and the ground around, as four strips.
#import "lib/camera.wgsl"
#import "lib/pool.wgsl"

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) @interpolate(flat) normal: vec3f,
    @location(2) @interpolate(flat) kind: u32,
}

/// A corner of a square from 0 to 1: two triangles, six vertices.
fn corner_of(index: u32) -> vec2f {
    let right = index == 1u || index == 2u || index == 4u;
    let up = index == 2u || index == 4u || index == 5u;
    return select(vec2f(0.0), vec2f(1.0), vec2<bool>(right, up));
}

/// Square 0 is the floor, 1 to 4 are walls, 5 to 8 the ground to the four sides of the pool.
@vertex
fn geometry(@builtin(vertex_index) index: u32) -> Vertex {
    let at = corner_of(index % 6u);
    let square = index / 6u;
    let low = basin.pool_min;
    let high = basin.pool_max;
    let middle = 0.5 * (low + high);
    var out: Vertex;
    out.kind = TILES;
    out.normal = vec3f(0.0, 1.0, 0.0);
    var flat = mix(low, high, at.yx);
    var y = basin.floor_m;
    if square >= 1u && square <= 4u {
        let axis = (square - 1u) / 2u;
        let far = (square & 1u) == 0u;
        let inward = select(1.0, -1.0, far);
        out.normal = select(vec3f(inward, 0.0, 0.0), vec3f(0.0, 0.0, inward), axis == 1u);
        // Turned so that the inside is the front.
        let along = select(at.x, 1.0 - at.x, far != (axis == 1u));
        flat[axis] = select(low[axis], high[axis], far);
        flat[1u - axis] = mix(high[1u - axis], low[1u - axis], along);
        y = mix(basin.floor_m, basin.rim_m, at.y);
    } else if square >= 5u {
        out.kind = GROUND;
        y = basin.rim_m;
        let out_low = middle - basin.ground_m;
        let out_high = middle + basin.ground_m;
        var from_to = vec4f(out_low, low.x, out_high.y);
        if square == 6u {
            from_to = vec4f(high.x, out_low.y, out_high);
        } else if square == 7u {
            from_to = vec4f(low.x, out_low.y, high.x, low.y);
        } else if square == 8u {
            from_to = vec4f(low.x, high.y, high.x, out_high.y);
        }
        flat = mix(from_to.xy, from_to.zw, at.yx);
    }
    if square == 0u && !has_walls() {
        out.kind = GROUND;
    }
    out.world = vec3f(flat.x, y, flat.y);
    out.clip = camera.clip_from_world * vec4f(out.world, 1.0);
    return out;
}

@fragment
fn shade(in: Vertex) -> @location(0) vec4f {
    let footprint = max(length(fwidth(in.world)) * 0.7, 1.0e-5);
    return pool_color(in.world, in.normal, in.kind, footprint);
}
