// From the middle of each cell to a batch of triangles: the least squared distance, and the solid angles that the
// triangles fill (Van Oosterom and Strackee 1983), whose sum tells inside from outside also where a mesh has small holes.
#import "lib/dispatch.wgsl"
#import "lib/meshes.wgsl"
#import "lib/packed.wgsl"

const WIDTH = 64u;
const BATCH = 512u;
const FULL_ANGLE = 12.566370614;

struct Params {
    columns: u32,
    rows: u32,
    cell: f32,
    batch: u32,
    low: vec3f,
}

struct Corners {
    a: vec3f,
    b: vec3f,
    c: vec3f,
}

var<uniform> params: Params;
var<storage, read> meshes_bodies: array<mat4x4f>;
var<storage, read> meshes_instances: array<Instance>;
var<storage, read> meshes_positions: array<Packed3>;
var<storage, read> meshes_triangles: array<Triangle>;
var<storage, read_write> nearest: array<f32>;
var<storage, read_write> winding: array<f32>;

// Triangles in world space, shared by the cells of a workgroup.
var<workgroup> shared_corners: array<Corners, 64>;

fn squared(v: vec3f) -> f32 {
    return dot(v, v);
}

/// Squared length of `to` after its part along `edge` is taken off, as far as the edge goes.
fn squared_to_edge(edge: vec3f, to: vec3f) -> f32 {
    return squared(edge * clamp(dot(edge, to) / max(squared(edge), 1e-30), 0.0, 1.0) - to);
}

/// Squared distance from the origin to a triangle.
fn squared_to_triangle(t: Corners) -> f32 {
    let ab = t.b - t.a;
    let bc = t.c - t.b;
    let ca = t.a - t.c;
    let normal = cross(ab, ca);
    let within = sign(dot(cross(ab, normal), -t.a)) + sign(dot(cross(bc, normal), -t.b)) + sign(dot(cross(ca, normal), -t.c));
    if within >= 2.0 {
        let height = dot(normal, t.a);
        return height * height / squared(normal);
    }
    return min(squared_to_edge(ab, -t.a), min(squared_to_edge(bc, -t.b), squared_to_edge(ca, -t.c)));
}

/// Solid angle of a triangle seen from the origin, positive from behind its front.
fn solid_angle(t: Corners) -> f32 {
    let l = vec3f(length(t.a), length(t.b), length(t.c));
    let volume = dot(t.a, cross(t.b, t.c));
    return 2.0 * atan2(volume, l.x * l.y * l.z + dot(t.a, t.b) * l.z + dot(t.b, t.c) * l.x + dot(t.c, t.a) * l.y);
}

@compute @workgroup_size(64)
fn measure(
    @builtin(global_invocation_id) global_id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let cell = linear_index(global_id, groups, WIDTH);
    let at = vec3u(cell % params.columns, (cell / params.columns) % params.rows, cell / (params.columns * params.rows));
    let p = params.low + (vec3f(at) + 0.5) * params.cell;
    var least = 1e30;
    var angle = 0.0;
    for (var i = 0u; i < arrayLength(&meshes_instances); i++) {
        let instance = meshes_instances[i];
        let world = meshes_bodies[instance.body] * instance.body_from_mesh;
        let begin = max(instance.first_triangle, params.batch * BATCH);
        let end = min(instance.first_triangle + instance.triangles, (params.batch + 1u) * BATCH);
        // What mirrors a body turns its fronts over.
        let front = sign(dot(world[0].xyz, cross(world[1].xyz, world[2].xyz)));
        for (var first = begin; first < end; first += WIDTH) {
            workgroupBarrier();
            if first + lane < end {
                let t = meshes_triangles[first + lane];
                shared_corners[lane] = Corners(
                    (world * vec4f(unpack3(meshes_positions[t.a]), 1.0)).xyz,
                    (world * vec4f(unpack3(meshes_positions[t.b]), 1.0)).xyz,
                    (world * vec4f(unpack3(meshes_positions[t.c]), 1.0)).xyz,
                );
            }
            workgroupBarrier();
            for (var k = 0u; k < min(WIDTH, end - first); k++) {
                let corners = shared_corners[k];
                let seen = Corners(corners.a - p, corners.b - p, corners.c - p);
                least = min(least, squared_to_triangle(seen));
                angle += front * solid_angle(seen);
            }
        }
    }
    if cell < arrayLength(&nearest) {
        nearest[cell] = min(nearest[cell], least);
        winding[cell] += angle / FULL_ANGLE;
    }
}
