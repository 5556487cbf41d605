// The scene with what blends behind the liquid: premultiplied colour, and eye z of the nearest (0: nothing).
#import "lib/camera.wgsl"

struct Seen {
    @location(0) color: vec4f,
    @location(1) z: f32,
}

var dry_color: texture_2d<f32>;
var dry_z: texture_2d<f32>;
var behind_color: texture_2d<f32>;
var behind_depth: texture_depth_multisampled_2d;

@fragment
fn join(@builtin(position) position: vec4f) -> Seen {
    let texel = vec2i(position.xy);
    let over = textureLoad(behind_color, texel, 0);
    var depth = 0.0;
    for (var k = 0; k < 4; k++) {
        depth = max(depth, textureLoad(behind_depth, texel, k));
    }
    let dry = textureLoad(dry_z, texel, 0).x;
    let z = select(eye_z_from_depth(max(depth, 1.0e-30)), -1.0e30, depth == 0.0);
    let nearest = max(z, select(dry, -1.0e30, dry == 0.0));
    return Seen(over + (1.0 - over.a) * textureLoad(dry_color, texel, 0), select(nearest, 0.0, nearest == -1.0e30));
}
