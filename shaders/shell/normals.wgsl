// Normals of smoothed depth layers, recomputed from their own depth (Imai 2016, end of section 4.3).
#import "lib/surface_normal.wgsl"

struct Params {
    particles_radius: f32,
}

var<uniform> params: Params;
var layers_z: texture_2d_array<f32>;
// The particles' own normals, for pixels that stand alone.
var layers_normal: texture_2d_array<f32>;
var smooth_normal: texture_storage_2d_array<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn normals(@builtin(global_invocation_id) id: vec3u) {
    let texel = vec2i(id.xy);
    if any(texel >= vec2i(textureDimensions(layers_z))) {
        return;
    }
    let z = textureLoad(layers_z, texel, id.z, 0).x;
    var normal = vec3f(0.0);
    if z != 0.0 {
        let particle = textureLoad(layers_normal, texel, id.z, 0).xyz;
        normal = surface_normal(layers_z, texel, id.z, z, params.particles_radius, particle);
    }
    textureStore(smooth_normal, texel, id.z, vec4f(normal, 0.0));
}
