// Discs that face the camera, shaded as spheres would be.

#import "lib/packed.wgsl"

// Members of a uniform that names no resource are filled by name: parameters, `let` names, `time`, and fields of
// inputs, written with `_` for the dot. No bindings are numbered by hand.
struct Settings {
    camera_clip_from_view: mat4x4f,
    camera_view_from_world: mat4x4f,
    sun_direction: vec3f,
    disc_m: f32,
    color: vec3f,
}

var<uniform> settings: Settings;
// The attribute `position` of the input `particles`.
var<storage, read> particles_position: array<Packed3>;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) at: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) particle: u32) -> Corner {
    let at = vec2f(f32(vertex & 1u), f32(vertex >> 1u)) * 2.0 - 1.0;
    let p_in_world = unpack3(particles_position[particle]);
    let p_in_view = settings.camera_view_from_world * vec4f(p_in_world, 1.0);
    let corner = p_in_view + vec4f(at * settings.disc_m, 0.0, 0.0);
    return Corner(settings.camera_clip_from_view * corner, at);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4f {
    let r2 = dot(corner.at, corner.at);
    if r2 > 1.0 {
        discard;
    }
    let n_in_view = vec3f(corner.at, sqrt(1.0 - r2));
    let to_sun = -(settings.camera_view_from_world * vec4f(settings.sun_direction, 0.0)).xyz;
    let light = 0.15 + 0.85 * max(dot(n_in_view, to_sun), 0.0);
    return vec4f(settings.color * light, 1.0);
}
