// The sky's irradiance.
#import "lib/harmonics.wgsl"

var<storage, read> ambient: array<vec4f>;

fn sky_irradiance(normal: vec3f) -> vec3f {
    let basis = harmonics(normal);
    var sum = vec3f(0.0);
    for (var k = 0u; k < 9u; k++) {
        sum += ambient[k].rgb * basis[k];
    }
    return max(sum, vec3f(0.0));
}
