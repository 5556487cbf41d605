// Irradiance of the cube map as nine coefficients, the brightest spots cut off (the sun is a light of its own).
#import "lib/cube.wgsl"
#import "lib/harmonics.wgsl"

const THREADS = 96u;
const ROW = 24u;

struct Params {
    ambient_max: f32,
}

var<uniform> params: Params;
var map_cube: texture_cube<f32>;
var linear_clamp: sampler;
var<storage, read_write> ambient: array<vec4f>;

var<workgroup> partial: array<array<vec3f, 9>, 96>;

@compute @workgroup_size(96)
fn gather(@builtin(local_invocation_index) lane: u32) {
    var sums = array<vec3f, 9>();
    // Each face as 24 x 24 samples; a thread takes a row of a face, then the next but 96.
    for (var row = lane; row < 6u * ROW; row += THREADS) {
        for (var column = 0u; column < ROW; column++) {
            let uv = (vec2f(f32(column), f32(row % ROW)) + 0.5) / f32(ROW);
            let ray = cube_direction(row / ROW, uv);
            let squared = dot(ray, ray);
            let solid_angle = 4.0 / (f32(ROW * ROW) * squared * sqrt(squared));
            let direction = ray * inverseSqrt(squared);
            let radiance = textureSampleLevel(map_cube, linear_clamp, direction, 0.0).rgb;
            let basis = harmonics(direction);
            for (var k = 0u; k < 9u; k++) {
                sums[k] += min(radiance, vec3f(params.ambient_max)) * basis[k] * solid_angle;
            }
        }
    }
    partial[lane] = sums;
    workgroupBarrier();
    if lane < 9u {
        var sum = vec3f(0.0);
        for (var other = 0u; other < THREADS; other++) {
            sum += partial[other][lane];
        }
        ambient[lane] = vec4f(sum * cosine_lobe(lane), 0.0);
    }
}
