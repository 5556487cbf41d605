//! Moving a camera by hand: around its target, sideways, to and fro, and flying.

use glam::{DMat3, DVec3};

use crate::scene::Camera;

/// How near to straight up or down an orbit comes, in radians.
const POLE: f64 = 0.01;
/// Distances to the target that a fly covers in a second.
const FLY_SPEED: f64 = 0.7;
/// Nearest and farthest distance to the target that zooming reaches, in metres.
const DISTANCE_M: [f64; 2] = [1e-4, 1e5];

/// Turns around the target, by radians to the right and up.
pub fn orbit(camera: &Camera, right: f64, up: f64) -> Camera {
    let axis = camera.up.normalize_or(DVec3::Y);
    let offset = camera.eye - camera.target;
    let distance = offset.length();
    let height = (offset.dot(axis) / distance).clamp(-1.0, 1.0).asin();
    let limit = std::f64::consts::FRAC_PI_2 - POLE;
    let raised = (height + up).clamp(-limit, limit);
    let flat = offset - axis * offset.dot(axis);
    // From straight above any way is as good.
    let flat = flat.normalize_or(axis.any_orthonormal_vector());
    let turned = DMat3::from_axis_angle(axis, right) * flat;
    let offset = (turned * raised.cos() + axis * raised.sin()) * distance;
    Camera { eye: camera.target + offset, ..*camera }
}

/// Moves sideways so that what is at the target's distance follows the pointer: by parts of the
/// picture's height to the right and down.
pub fn pan(camera: &Camera, right: f64, down: f64) -> Camera {
    let [x, y, _] = axes(camera);
    let height = 2.0 * (camera.fov_degrees.to_radians() * 0.5).tan() * camera.eye.distance(camera.target);
    let shift = (y * down - x * right) * height;
    Camera { eye: camera.eye + shift, target: camera.target + shift, ..*camera }
}

/// Scales the distance to the target.
pub fn zoom(camera: &Camera, factor: f64) -> Camera {
    let offset = camera.eye - camera.target;
    let distance = offset.length();
    let wanted = (distance * factor).clamp(DISTANCE_M[0], DISTANCE_M[1]);
    Camera { eye: camera.target + offset * (wanted / distance), ..*camera }
}

/// Flies: right, up and forward in parts of the usual speed, for some seconds.
pub fn fly(camera: &Camera, way: [f64; 3], seconds: f64) -> Camera {
    let [x, y, z] = axes(camera);
    let way = x * way[0] + y * way[1] + z * way[2];
    let shift = way * (camera.eye.distance(camera.target) * FLY_SPEED * seconds);
    Camera { eye: camera.eye + shift, target: camera.target + shift, ..*camera }
}

/// Turns the head: radians to the right and up.
pub fn look(camera: &Camera, right: f64, up: f64) -> Camera {
    // The eye orbits the target just as the target orbits the eye.
    let swapped = Camera { eye: camera.target, target: camera.eye, ..*camera };
    let turned = orbit(&swapped, -right, up);
    Camera { target: turned.eye, ..*camera }
}

/// Looks at the whole of a box from where the camera stands.
pub fn frame(camera: &Camera, low: DVec3, high: DVec3, viewport: [u32; 2]) -> Camera {
    let middle = (low + high) * 0.5;
    let radius = (high - low).length().max(1e-3) * 0.5;
    let tan = camera.tan_half_fov(viewport).into_iter().fold(f64::INFINITY, f64::min);
    let [_, _, forward] = axes(camera);
    let distance = radius / tan.atan().sin();
    Camera { eye: middle - forward * distance, target: middle, ..*camera }
}

/// The way from the eye through a place in the picture, from -1 to 1 to the right and up.
pub fn ray(camera: &Camera, at: [f64; 2], viewport: [u32; 2]) -> DVec3 {
    let [x, y, forward] = axes(camera);
    let [tan_x, tan_y] = camera.tan_half_fov(viewport);
    (forward + x * (at[0] * tan_x) + y * (at[1] * tan_y)).normalize()
}

/// Right, up and forward.
fn axes(camera: &Camera) -> [DVec3; 3] {
    let view = camera.view_from_world();
    let rows = [view.row(0), view.row(1), view.row(2)].map(|row| row.truncate());
    [rows[0], rows[1], -rows[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::new(DVec3::new(3.0, 2.0, 4.0), DVec3::new(0.5, 0.5, 0.0), 40.0)
    }

    /// Where a point is in the picture, both from -1 to 1.
    fn seen(camera: &Camera, point: DVec3, size: [u32; 2]) -> [f64; 2] {
        let clip = camera.clip_from_view(size) * camera.view_from_world() * point.extend(1.0);
        [clip.x / clip.w, clip.y / clip.w]
    }

    #[test]
    fn an_orbit_keeps_distance_and_target_and_stops_before_the_poles() {
        let before = camera();
        let mut moved = before;
        for _ in 0..100 {
            moved = orbit(&moved, 0.3, 0.2);
            assert_eq!(moved.fault(), None);
        }
        assert_eq!(moved.target, before.target);
        assert!((moved.eye.distance(moved.target) - before.eye.distance(before.target)).abs() < 1e-9);
        let up = (moved.eye - moved.target).normalize().y;
        assert!(up > 0.999 && up < 1.0);
    }

    #[test]
    fn there_and_back_is_where_it_began() {
        let before = camera();
        for moved in [
            orbit(&orbit(&before, 0.4, 0.1), -0.4, -0.1),
            pan(&pan(&before, 0.2, -0.1), -0.2, 0.1),
            zoom(&zoom(&before, 2.0), 0.5),
            fly(&fly(&before, [1.0, 0.5, 2.0], 0.1), [-1.0, -0.5, -2.0], 0.1),
            look(&look(&before, 0.2, 0.1), -0.2, -0.1),
        ] {
            assert!(moved.eye.distance(before.eye) < 1e-9, "{moved:?}");
            assert!(moved.target.distance(before.target) < 1e-9, "{moved:?}");
        }
    }

    #[test]
    fn what_is_dragged_follows_the_pointer() {
        let before = camera();
        let size = [800, 600];
        let [x, y] = seen(&pan(&before, 0.25, 0.1), before.target, size);
        // A quarter of the height to the right is half of it from the middle to the border.
        assert!((x - 0.5 * 600.0 / 800.0).abs() < 1e-9, "{x}");
        assert!((y + 0.2).abs() < 1e-9, "{y}");
        // Orbiting to the right by dragging to the left: the near side follows the pointer.
        let near = before.target + (before.eye - before.target).normalize() * 0.1;
        assert!(seen(&orbit(&before, -0.1, 0.0), near, size)[0] > 0.0);
    }

    #[test]
    fn framing_shows_all_of_a_box() {
        let (low, high) = (DVec3::new(-1.0, 0.0, 2.0), DVec3::new(3.0, 0.5, 2.5));
        for size in [[800, 600], [300, 900]] {
            let framed = frame(&camera(), low, high, size);
            for corner in 0..8 {
                let pick = |bit: usize, axis: usize| if corner >> bit & 1 == 1 { high[axis] } else { low[axis] };
                let [x, y] = seen(&framed, DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2)), size);
                assert!(x.abs() <= 1.0 && y.abs() <= 1.0, "{x} {y}");
            }
        }
        assert_eq!(frame(&camera(), DVec3::ONE, DVec3::ONE, [8, 8]).fault(), None);
    }

    #[test]
    fn a_ray_meets_what_is_seen_at_its_place() {
        let (camera, size) = (camera(), [800, 600]);
        let point = DVec3::new(0.8, 0.2, -0.3);
        let way = ray(&camera, seen(&camera, point, size), size);
        assert!((point - camera.eye).normalize().distance(way) < 1e-9);
    }

    #[test]
    fn zooming_has_ends() {
        let near = (0..400).fold(camera(), |c, _| zoom(&c, 0.5));
        let far = (0..400).fold(camera(), |c, _| zoom(&c, 2.0));
        assert_eq!((near.fault(), far.fault()), (None, None));
    }
}
