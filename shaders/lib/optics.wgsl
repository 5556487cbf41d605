// Refraction and reflection at a smooth surface between air and a liquid.

struct Bend {
    // Unit direction of the refracted ray; of the reflected one in total reflection.
    direction: vec3f,
    // Share of the light that is reflected; 1 in total reflection.
    reflectance: f32,
}

/// Schlick's approximation (Imai 2016, section 4.5); `cosine` is that of the angle on the air's side.
fn schlick(cosine: f32, ior: f32) -> f32 {
    let ratio = (ior - 1.0) / (ior + 1.0);
    let facing = ratio * ratio;
    let rest = clamp(1.0 - cosine, 0.0, 1.0);
    let squared = rest * rest;
    return facing + (1.0 - facing) * squared * squared * rest;
}

/// Snell's law for a unit direction and a unit normal that faces it, from air into the liquid.
fn bend_in(direction: vec3f, normal: vec3f, ior: f32) -> Bend {
    let eta = 1.0 / ior;
    let cosine = clamp(-dot(direction, normal), 0.0, 1.0);
    let inner = sqrt(max(1.0 - eta * eta * (1.0 - cosine * cosine), 0.0));
    return Bend(normalize(eta * direction + (eta * cosine - inner) * normal), schlick(cosine, ior));
}

/// The same from the liquid into air, with total reflection.
fn bend_out(direction: vec3f, normal: vec3f, ior: f32) -> Bend {
    let cosine = clamp(-dot(direction, normal), 0.0, 1.0);
    let outer_2 = 1.0 - ior * ior * (1.0 - cosine * cosine);
    if outer_2 <= 0.0 {
        return Bend(reflect(direction, normal), 1.0);
    }
    let outer = sqrt(outer_2);
    return Bend(normalize(ior * direction + (ior * cosine - outer) * normal), schlick(outer, ior));
}

/// The Beer-Lambert law (Imai 2016, equation 9): what is left of each colour after a path in metres.
fn transmitted(absorption_per_m: vec3f, path_m: f32) -> vec3f {
    return exp(-absorption_per_m * max(path_m, 0.0));
}

/// Fresnel's reflectance of unpolarised light that comes from the air; `cosine` is that of the angle there.
fn fresnel(cosine: f32, ior: f32) -> f32 {
    let inner = sqrt(max(1.0 - (1.0 - cosine * cosine) / (ior * ior), 0.0));
    let across = (cosine - ior * inner) / (cosine + ior * inner);
    let along = (ior * cosine - inner) / (ior * cosine + inner);
    return 0.5 * (across * across + along * along);
}
