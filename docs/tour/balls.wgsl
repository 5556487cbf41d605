// Every particle as a ball: how long a ray through it is, in metres.
#import "lib/camera.wgsl"
#import "lib/packed.wgsl"

struct Params {
    radius_m: f32,
}

struct Ball {
    @builtin(position) clip: vec4f,
    @location(0) corner: vec2f,
}

var<uniform> params: Params;
var<storage, read> particles_position: array<Packed3>;

@vertex
fn quad(@builtin(vertex_index) i: u32, @builtin(instance_index) particle: u32) -> Ball {
    let corner = 2.0 * vec2f(f32(i & 1u), f32(i >> 1u)) - 1.0;
    let centre = eye_from_world_point(unpack3(particles_position[particle]));
    let clip = camera.clip_from_view * vec4f(centre + vec3f(params.radius_m * corner, 0.0), 1.0);
    return Ball(clip, corner);
}

@fragment
fn chord(in: Ball) -> @location(0) f32 {
    let squared = dot(in.corner, in.corner);
    if squared > 1.0 {
        discard;
    }
    return 2.0 * params.radius_m * sqrt(1.0 - squared);
}
