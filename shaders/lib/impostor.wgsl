// Ray-cast ellipsoids on screen-aligned quads (Sigg et al. 2006, as Imai 2016 section 4.2 uses it).
#import "lib/camera.wgsl"

/// What a quad hands to its fragments. Rows of `to_unit` take eye space to the space in which the ellipsoid is
/// the unit sphere; `centre` is the ellipsoid's centre there, seen from the eye.
struct Impostor {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) to_unit_x: vec3f,
    @location(1) @interpolate(flat) to_unit_y: vec3f,
    @location(2) @interpolate(flat) to_unit_z: vec3f,
    @location(3) @interpolate(flat) centre: vec3f,
}

struct ImpostorHit {
    hit: bool,
    z: f32,
    normal: vec3f,
}

/// Both ends in x / -z (or y / -z) of an ellipsoid seen from the origin: planes through the eye that touch it.
/// `s` is the sum of the axes' outer products; terms of the fourth power of the distance are cancelled by hand.
fn tangent_ends(s_aa: f32, s_az: f32, s_zz: f32, c_a: f32, c_z: f32) -> vec2f {
    let m_az = s_az - c_a * c_z;
    let m_zz = s_zz - c_z * c_z;
    let root = s_az * s_az - s_aa * s_zz - 2.0 * s_az * c_a * c_z + s_aa * c_z * c_z + s_zz * c_a * c_a;
    let width = sqrt(max(root, 0.0));
    return vec2f(-m_az + width, -m_az - width) / m_zz;
}

/// Corner 0 to 3 of a triangle strip around an ellipsoid; nothing for one behind the near plane, the whole screen
/// for one that reaches through it.
fn impostor(corner: u32, centre_in_view: vec3f, axes_in_view: mat3x3f) -> Impostor {
    let a = axes_in_view[0];
    let b = axes_in_view[1];
    let c = axes_in_view[2];
    var out: Impostor;
    out.to_unit_x = a / dot(a, a);
    out.to_unit_y = b / dot(b, b);
    out.to_unit_z = c / dot(c, c);
    out.centre = vec3f(
        dot(out.to_unit_x, centre_in_view),
        dot(out.to_unit_y, centre_in_view),
        dot(out.to_unit_z, centre_in_view),
    );

    let s_diagonal = a * a + b * b + c * c;
    let s_z = a * a.z + b * b.z + c * c.z;
    let reach = sqrt(s_diagonal.z);
    var low = vec2f(-1.0);
    var high = vec2f(1.0);
    let scale = vec2f(camera.clip_from_view[0][0], camera.clip_from_view[1][1]);
    if camera.orthographic != 0u {
        low = (centre_in_view.xy - sqrt(s_diagonal.xy)) * scale;
        high = (centre_in_view.xy + sqrt(s_diagonal.xy)) * scale;
    } else if centre_in_view.z + reach < -camera.near {
        let x = tangent_ends(s_diagonal.x, s_z.x, s_diagonal.z, centre_in_view.x, centre_in_view.z);
        let y = tangent_ends(s_diagonal.y, s_z.y, s_diagonal.z, centre_in_view.y, centre_in_view.z);
        low = vec2f(min(x.x, x.y), min(y.x, y.y)) * scale;
        high = vec2f(max(x.x, x.y), max(y.x, y.y)) * scale;
    } else if centre_in_view.z - reach > -camera.near {
        low = vec2f(2.0);
        high = vec2f(2.0);
    }
    let right_top = vec2f(f32(corner & 1u), f32(corner >> 1u));
    // Depth is written by the fragments; the corners only have to lie between the planes.
    out.position = vec4f(mix(low, high, right_top), 0.5, 1.0);
    return out;
}

/// The front (or back) surface of the impostor's ellipsoid at a fragment: eye z and the outward normal in eye space.
fn impostor_hit(quad: Impostor, back: bool) -> ImpostorHit {
    let ray = eye_ray(quad.position.xy);
    let direction = vec3f(
        dot(quad.to_unit_x, ray.direction),
        dot(quad.to_unit_y, ray.direction),
        dot(quad.to_unit_z, ray.direction),
    );
    let origin = vec3f(
        dot(quad.to_unit_x, ray.origin),
        dot(quad.to_unit_y, ray.origin),
        dot(quad.to_unit_z, ray.origin),
    );
    // From the point of the ray that is nearest to the centre, which keeps the small numbers small.
    let squared = dot(direction, direction);
    let middle = dot(quad.centre - origin, direction) / squared;
    let nearest = origin + middle * direction - quad.centre;
    let rest = 1.0 - dot(nearest, nearest);
    if rest <= 0.0 {
        return ImpostorHit(false, 0.0, vec3f(0.0));
    }
    let half_chord = sqrt(rest / squared) * select(-1.0, 1.0, back);
    let z = -(middle + half_chord);
    let unit = nearest + half_chord * direction;
    let normal = normalize(quad.to_unit_x * unit.x + quad.to_unit_y * unit.y + quad.to_unit_z * unit.z);
    return ImpostorHit(z < -camera.near, z, normal);
}
