// White balance: light of a colour temperature shown as white (the Planckian locus after Kim et al. 2002, adaptation
// after Bradford).

/// sRGB's white, about that of daylight.
const DAYLIGHT_K = 6504.0;
const CONE_FROM_RGB = mat3x3f(
    0.42272529, 0.05569978, 0.02138264,
    0.49134532, 0.96153405, 0.08764187,
    0.02735794, 0.02318381, 0.98050813,
);
const RGB_FROM_CONE = mat3x3f(
    2.53804452, -0.14600406, -0.04229851,
    -1.29327700, 1.11664831, -0.07160722,
    -0.04023688, -0.02232903, 1.02275269,
);
const CONE_FROM_XYZ = mat3x3f(
    0.8951, -0.7502, 0.0389,
    0.2664, 1.7135, -0.0685,
    -0.1614, 0.0367, 1.0296,
);

/// What the three cones see of a glowing body's light, at luminance 1; `tint` goes from green to magenta.
fn cones_of_white(kelvin: f32, tint: f32) -> vec3f {
    let t = 1000.0 / kelvin;
    let cool = vec4f(-3.0258469, 2.1070379, 0.2226347, 0.240390);
    let warm = vec4f(-0.2661239, -0.2343589, 0.8776956, 0.179910);
    let x = dot(select(warm, cool, kelvin >= 4000.0), vec4f(t * t * t, t * t, t, 1.0));
    let coolest = vec4f(3.0817580, -5.87338670, 3.75112997, -0.37001483);
    let middle = vec4f(-0.9549476, -1.37418593, 2.09137015, -0.16748867);
    let warmest = vec4f(-1.1063814, -1.34811020, 2.18555832, -0.20219683);
    let curve = select(select(coolest, middle, kelvin < 4000.0), warmest, kelvin < 2222.0);
    // Magenta light has less green in it than white.
    let y = dot(curve, vec4f(x * x * x, x * x, x, 1.0)) - 0.03 * tint;
    return CONE_FROM_XYZ * vec3f(x / y, 1.0, (1.0 - x - y) / y);
}

/// A linear colour as it looks to eyes that take light of this temperature and tint for white. Daylight changes nothing.
/// No branch depends on the values: a software driver would compile the shader again for each of them.
fn white_balanced(color: vec3f, kelvin: f32, tint: f32) -> vec3f {
    let gain = cones_of_white(DAYLIGHT_K, 0.0) / cones_of_white(kelvin, tint);
    let balanced = max(RGB_FROM_CONE * (gain * (CONE_FROM_RGB * color)), vec3f(0.0));
    return select(balanced, color, kelvin == DAYLIGHT_K && tint == 0.0);
}
