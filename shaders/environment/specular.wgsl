// The environment as rough surfaces mirror it: for each mip the mean over GGX's lobe of its roughness, seen along the
// normal (Karis 2013, "Real Shading in Unreal Engine 4"). Mip 0 is a mirror.
#import "lib/cube.wgsl"

struct Params {
    roughness: f32,
    ambient_max: f32,
}

const SAMPLES = 96u;

var<uniform> params: Params;
var sky: texture_cube<f32>;
var linear_clamp: sampler;
var specular: texture_storage_2d_array<rgba16float, write>;

/// The bits of a number mirrored behind the point (van der Corput).
fn mirrored_bits(n: u32) -> f32 {
    return f32(reverseBits(n)) / 4294967296.0;
}

@compute @workgroup_size(8, 8)
fn blur(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(specular);
    if any(id.xy >= size) {
        return;
    }
    let normal = normalize(cube_direction(id.z, (vec2f(id.xy) + 0.5) / vec2f(size)));
    if params.roughness == 0.0 {
        let seen = textureSampleLevel(sky, linear_clamp, normal, 0.0).rgb;
        textureStore(specular, id.xy, id.z, vec4f(min(seen, vec3f(params.ambient_max)), 1.0));
        return;
    }
    let up = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(normal.y) > 0.9);
    let tangent = normalize(cross(up, normal));
    let bitangent = cross(normal, tangent);
    let alpha = params.roughness * params.roughness;
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var k = 0u; k < SAMPLES; k++) {
        let angle = 6.2831853 * (f32(k) + 0.5) / f32(SAMPLES);
        let u = mirrored_bits(k);
        let cosine = sqrt((1.0 - u) / (1.0 + (alpha * alpha - 1.0) * u));
        let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
        let half = sine * cos(angle) * tangent + sine * sin(angle) * bitangent + cosine * normal;
        let direction = reflect(-normal, half);
        let weight = dot(direction, normal);
        if weight > 0.0 {
            // The sun is a light of its own.
            let seen = textureSampleLevel(sky, linear_clamp, direction, 0.0).rgb;
            sum += weight * min(seen, vec3f(params.ambient_max));
            weights += weight;
        }
    }
    textureStore(specular, id.xy, id.z, vec4f(sum / max(weights, 1.0e-4), 1.0));
}
