// The light at a place of a surface.

struct SurfaceLight {
    // Irradiance by the sky.
    sky: vec3f,
    // Share of the sky's picture that is there to be mirrored.
    mirrored: vec3f,
    // Irradiance by the sun, and where its light comes from.
    sun: vec3f,
    towards_sun: vec3f,
}
