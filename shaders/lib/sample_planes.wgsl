// Light between the sample planes of `parts/caustics.ron`, for whatever lies there.
#import "lib/linear_clamp.wgsl"
#import "lib/planes_place.wgsl"

var<uniform> stack: PlanesPlace;
var caustics: texture_2d_array<f32>;

/// Light through a level square metre at a point; w is 0 outside the planes.
fn between_planes(p: vec3f) -> vec4f {
    let uv = (p.xz - stack.region_min) / (stack.region_max - stack.region_min);
    // Walls may stand right on the rectangle.
    if any(abs(uv - 0.5) > vec2f(0.5001)) || p.y > stack.top_m {
        return vec4f(0.0);
    }
    let planes = textureNumLayers(caustics);
    let down = (stack.top_m - p.y) / (stack.top_m - stack.bottom_m);
    let layer = clamp(down, 0.0, 1.0) * f32(planes - 1u);
    let above = i32(layer);
    let below = min(above + 1, i32(planes) - 1);
    let upper = textureSampleLevel(caustics, linear_clamp, uv, above, 0.0).rgb;
    let lower = textureSampleLevel(caustics, linear_clamp, uv, below, 0.0).rgb;
    return vec4f(mix(upper, lower, layer - f32(above)), 1.0);
}
