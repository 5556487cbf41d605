// The sheet, lit by the sun, on the plane y = 0 from -1 to 1 in x and z.

struct Settings {
    camera_world_from_clip: mat4x4f,
    camera_position: vec3f,
    camera_viewport: vec2f,
    sun_direction: vec3f,
    cell_m: f32,
    color: vec3f,
}

var<uniform> settings: Settings;
// Outside `Steps` it is what the last step left.
var sheet: texture_2d<f32>;

fn height(texel: vec2i) -> f32 {
    return textureLoad(sheet, clamp(texel, vec2i(0), vec2i(textureDimensions(sheet)) - 1), 0).x;
}

@fragment
fn show(@builtin(position) position: vec4f) -> @location(0) vec4f {
    // The ray through the pixel: depth is 1 at the near plane.
    let ndc = vec2f(2.0, -2.0) * position.xy / settings.camera_viewport + vec2f(-1.0, 1.0);
    let near = settings.camera_world_from_clip * vec4f(ndc, 1.0, 1.0);
    let ray = near.xyz / near.w - settings.camera_position;
    let at = settings.camera_position.xz - ray.xz * settings.camera_position.y / ray.y;
    if ray.y >= 0.0 || any(abs(at) > vec2f(1.0)) {
        return vec4f(0.0);
    }
    let texel = vec2i((at + 1.0) / settings.cell_m);
    let slope = vec2f(
        height(texel + vec2i(1, 0)) - height(texel - vec2i(1, 0)),
        height(texel + vec2i(0, 1)) - height(texel - vec2i(0, 1)),
    ) / (2.0 * settings.cell_m);
    // Steeper than it is, so that small waves show.
    let normal = normalize(vec3f(-3.0 * slope.x, 1.0, -3.0 * slope.y));
    let light = max(dot(normal, -settings.sun_direction), 0.0);
    let mirrored = reflect(normalize(ray), normal);
    let shine = pow(max(dot(mirrored, -settings.sun_direction), 0.0), 40.0);
    return vec4f(settings.color * (0.3 + light) + 0.6 * shine, 1.0);
}
