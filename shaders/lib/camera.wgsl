// The viewer: eye space is right-handed and looks along -z (in front z < 0), depth is reversed (near 1, far 0).
// Pixels are counted from the top left corner, their centres lie at .5.

struct Camera {
    clip_from_world: mat4x4f,
    clip_from_view: mat4x4f,
    view_from_world: mat4x4f,
    world_from_view: mat4x4f,
    position: vec3f,
    near: f32,
    viewport: vec2f,
    orthographic: u32,
}

var<uniform> camera: Camera;

/// A ray in eye space: the point at z is origin + direction * -z, since direction.z is -1.
struct EyeRay {
    origin: vec3f,
    direction: vec3f,
}

fn eye_ray(pixel: vec2f) -> EyeRay {
    let ndc = vec2f(2.0, -2.0) * pixel / camera.viewport + vec2f(-1.0, 1.0);
    let side = ndc / vec2f(camera.clip_from_view[0][0], camera.clip_from_view[1][1]);
    if camera.orthographic != 0u {
        return EyeRay(vec3f(side, 0.0), vec3f(0.0, 0.0, -1.0));
    }
    return EyeRay(vec3f(0.0), vec3f(side, -1.0));
}

/// The point seen through a pixel at eye-space z.
fn eye_from_pixel(pixel: vec2f, z: f32) -> vec3f {
    let ray = eye_ray(pixel);
    return ray.origin - z * ray.direction;
}

/// Where a point in front of the eye is seen; meaningless for z >= 0 in perspective.
fn pixel_from_eye(p_in_view: vec3f) -> vec2f {
    let scale = vec2f(camera.clip_from_view[0][0], camera.clip_from_view[1][1]);
    let w = select(-p_in_view.z, 1.0, camera.orthographic != 0u);
    let ndc = scale * p_in_view.xy / w;
    return (ndc * vec2f(0.5, -0.5) + 0.5) * camera.viewport;
}

/// Depth as the depth buffer holds it (near 1, far 0).
fn depth_from_eye_z(z: f32) -> f32 {
    let w = select(-z, 1.0, camera.orthographic != 0u);
    return (camera.clip_from_view[2][2] * z + camera.clip_from_view[3][2]) / w;
}

/// Eye-space z of a value of the depth buffer; 0 for the empty background in perspective.
fn eye_z_from_depth(depth: f32) -> f32 {
    let a = camera.clip_from_view[2][2];
    let b = camera.clip_from_view[3][2];
    if camera.orthographic != 0u {
        return (depth - b) / a;
    }
    return select(0.0, -b / (depth + a), depth > 0.0);
}

fn on_screen(pixel: vec2f) -> bool {
    return all(pixel >= vec2f(0.0)) && all(pixel < camera.viewport);
}

fn world_from_eye_vector(v_in_view: vec3f) -> vec3f {
    return (camera.world_from_view * vec4f(v_in_view, 0.0)).xyz;
}

fn eye_from_world_point(p_in_world: vec3f) -> vec3f {
    return (camera.view_from_world * vec4f(p_in_world, 1.0)).xyz;
}
