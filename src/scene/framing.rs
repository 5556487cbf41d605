//! A camera for particles that came without one: a three-quarter view from above that shows them
//! all, but for the few that fly far from the rest.

use glam::DVec3;

use super::camera::Camera;

/// From the particles towards the eye.
const TOWARDS_EYE: DVec3 = DVec3::new(0.62, 0.52, 1.0);
/// Vertical, in degrees.
pub const FOV_DEGREES: f64 = 40.0;
/// What the particles fill of the picture's width or height.
const FILL: f64 = 0.86;
/// Particles outside these quantiles of an axis, widened by `WIDEN` of their distance, are strays.
const QUANTILE: f64 = 0.005;
const WIDEN: f64 = 0.25;
/// More than enough to tell quantiles; keeps framing in fractions of a millisecond.
const MOST_SAMPLES: usize = 20_000;

/// Frames `positions` (metres) of spheres of `radius_m` in a picture of `viewport` pixels. Without
/// particles the camera looks at the origin.
pub fn frame(positions: &[[f32; 3]], radius_m: f64, viewport: [u32; 2], fov_degrees: f64) -> Camera {
    let sampled = sample(positions);
    if sampled.is_empty() {
        return Camera::new(TOWARDS_EYE.normalize() * 4.0, DVec3::ZERO, fov_degrees);
    }
    let (min, max) = robust_bounds(&sampled);
    let kept = sampled.iter().copied().filter(|p| p.cmpge(min).all() && p.cmple(max).all());
    fit(kept, (min + max) * 0.5, radius_m, viewport, fov_degrees)
}

fn sample(positions: &[[f32; 3]]) -> Vec<DVec3> {
    let stride = positions.len().div_ceil(MOST_SAMPLES).max(1);
    positions.iter().step_by(stride).map(|p| DVec3::from_array(p.map(f64::from))).collect()
}

fn robust_bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let (mut min, mut max) = (DVec3::ZERO, DVec3::ZERO);
    for axis in 0..3 {
        let mut values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
        let cut = (values.len() as f64 * QUANTILE) as usize;
        let last = values.len() - 1;
        let low = *values.select_nth_unstable_by(cut, f64::total_cmp).1;
        let high = *values.select_nth_unstable_by(last - cut, f64::total_cmp).1;
        let room = (high - low) * WIDEN;
        (min[axis], max[axis]) = (low - room, high + room);
    }
    (min, max)
}

/// The nearest eye in the fixed direction from which all points lie inside the picture: each side
/// plane of the view pyramid is pushed out to touch its outermost point.
fn fit(
    points: impl Iterator<Item = DVec3>,
    middle: DVec3,
    radius_m: f64,
    viewport: [u32; 2],
    fov_degrees: f64,
) -> Camera {
    let back = TOWARDS_EYE.normalize();
    let probe = Camera::new(middle + back, middle, fov_degrees);
    let [tan_x, tan_y] = probe.tan_half_fov(viewport).map(|tan| tan * FILL);
    let view = probe.view_from_world();
    let mut reach = [f64::NEG_INFINITY; 4];
    let mut nearest = f64::NEG_INFINITY;
    for p in points {
        let p = view.transform_point3(p);
        for (reach, side) in reach.iter_mut().zip([
            p.x + tan_x * p.z + radius_m * tan_x.hypot(1.0),
            -p.x + tan_x * p.z + radius_m * tan_x.hypot(1.0),
            p.y + tan_y * p.z + radius_m * tan_y.hypot(1.0),
            -p.y + tan_y * p.z + radius_m * tan_y.hypot(1.0),
        ]) {
            *reach = reach.max(side);
        }
        nearest = nearest.max(p.z + radius_m);
    }
    let [right, left, top, bottom] = reach;
    // Never inside the nearest particle, also where radius and extent are tiny.
    let z = ((right + left) / (2.0 * tan_x)).max((top + bottom) / (2.0 * tan_y)).max(nearest + 1e-3);
    let eye_in_view = DVec3::new((right - left) * 0.5, (top - bottom) * 0.5, z);
    let world = view.inverse();
    let eye = world.transform_point3(eye_in_view);
    let middle_z = view.transform_point3(middle).z.min(z - 1e-3);
    Camera::new(eye, eye - back * (z - middle_z), fov_degrees)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(n: i32) -> Vec<[f32; 3]> {
        let axis = move || (0..n).map(move |i| i as f32 / (n - 1) as f32);
        axis().flat_map(|x| axis().flat_map(move |y| axis().map(move |z| [x, y, z]))).collect()
    }

    /// The largest |x| and |y| of any particle in the picture, where 1 is its border.
    fn reach(camera: &Camera, points: &[[f32; 3]], size: [u32; 2]) -> (f64, f64) {
        let clip = camera.clip_from_view(size) * camera.view_from_world();
        points.iter().fold((0.0f64, 0.0f64), |(x, y), p| {
            let c = clip * DVec3::from_array(p.map(f64::from)).extend(1.0);
            assert!(c.w > 0.0, "behind the eye");
            (x.max((c.x / c.w).abs()), y.max((c.y / c.w).abs()))
        })
    }

    #[test]
    fn all_particles_fill_the_picture_and_none_leaves_it() {
        for size in [[1024, 768], [400, 900], [1600, 300]] {
            let points = cube(9);
            let camera = frame(&points, 0.02, size, FOV_DEGREES);
            let (x, y) = reach(&camera, &points, size);
            assert!(x < 0.9 && y < 0.9, "{x} {y} at {size:?}");
            assert!(x.max(y) > 0.75, "{x} {y} at {size:?}");
        }
    }

    #[test]
    fn a_few_strays_do_not_shrink_the_picture() {
        let mut points = cube(20);
        let calm = frame(&points, 0.02, [640, 480], FOV_DEGREES);
        points.extend((0..20).map(|i| [0.5, 5.0 + i as f32, 0.5]));
        let with_strays = frame(&points, 0.02, [640, 480], FOV_DEGREES);
        let distance = |camera: &Camera| camera.eye.distance(camera.target);
        assert!(distance(&with_strays) < 1.2 * distance(&calm));
    }

    #[test]
    fn one_particle_none_and_many_in_one_place_have_a_camera() {
        for points in [vec![], vec![[1.0, 2.0, 3.0]], vec![[0.0; 3]; 1000]] {
            let camera = frame(&points, 0.025, [640, 480], FOV_DEGREES);
            assert_eq!(camera.fault(), None, "{points:?}");
        }
    }
}
