//! A glass ball in closed form.

pub type Vector = [f64; 3];

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn along(a: Vector, t: f64, d: Vector) -> Vector {
    [a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]]
}

pub fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// A ray's way through a ball.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// How far beside the centre the ray passes, as a share of the radius.
    pub beside: f64,
    /// Unit direction after the second surface.
    pub direction: Vector,
    /// Path inside.
    pub path: f64,
}

/// From the origin in a unit direction through a ball ahead; nothing if it misses.
pub fn pass(direction: Vector, centre: Vector, radius: f64, ior: f64) -> Option<Passage> {
    let ahead = dot(direction, centre);
    let nearest = along(centre, -ahead, direction);
    let beside = dot(nearest, nearest).sqrt() / radius;
    if beside >= 1.0 {
        return None;
    }
    let entry = direction.map(|x| x * (ahead - radius * (1.0 - beside * beside).sqrt()));
    let outward = |p: Vector| [0, 1, 2].map(|k| (p[k] - centre[k]) / radius);
    let normal = outward(entry);
    let inner = refract(direction, normal, 1.0 / ior);
    let path = -2.0 * radius * dot(normal, inner);
    let exit = along(entry, path, inner);
    let leaving = refract(inner, outward(exit).map(|x| -x), ior);
    Some(Passage { beside, direction: unit(leaving), path })
}

/// Snell's law; the normal faces the ray.
fn refract(direction: Vector, normal: Vector, eta: f64) -> Vector {
    let cosine = -dot(direction, normal);
    let rest = (1.0 - eta * eta * (1.0 - cosine * cosine)).max(0.0);
    along(direction.map(|x| eta * x), eta * cosine - rest.sqrt(), normal)
}
