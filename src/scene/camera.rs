//! Cameras: right-handed, looking along -z in view space, with reversed infinite depth (the near
//! plane is 1, infinity is 0). All mathematics is in `f64`; uniforms are rounded at the very end.

use glam::{DMat4, DVec3, DVec4};

use crate::graph::value::Value;

/// A perspective camera in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub eye: DVec3,
    pub target: DVec3,
    /// Where the picture's top points; need not be unit or perpendicular.
    pub up: DVec3,
    /// Vertical, in degrees, more than 0 and less than 180.
    pub fov_degrees: f64,
    /// Distance of the near plane; absent: a thousandth of the distance to the target.
    pub near_m: Option<f64>,
}

impl Camera {
    /// Looks from `eye` at `target` with y up.
    pub fn new(eye: DVec3, target: DVec3, fov_degrees: f64) -> Self {
        Self { eye, target, up: DVec3::Y, fov_degrees, near_m: None }
    }

    /// What keeps it from making a picture, if anything does.
    pub fn fault(&self) -> Option<&'static str> {
        if !(self.eye.is_finite() && self.target.is_finite() && self.up.is_finite()) {
            Some("a camera's eye, target and up must be finite")
        } else if self.eye.distance(self.target) <= 1e-9 * self.eye.length().max(1.0) {
            Some("a camera's eye and target must be apart")
        } else if self.up.length_squared() == 0.0 {
            Some("a camera's up must not be zero")
        } else if !(self.fov_degrees > 0.0 && self.fov_degrees < 180.0) {
            Some("a camera's field of view must be more than 0 and less than 180 degrees")
        } else if self.near_m.is_some_and(|near| !(near.is_finite() && near > 0.0)) {
            Some("a camera's near plane must be at a distance above 0")
        } else {
            None
        }
    }

    pub fn near_m(&self) -> f64 {
        self.near_m.unwrap_or_else(|| self.eye.distance(self.target) * 1e-3)
    }

    /// Tangents of half the field of view, horizontal and vertical.
    pub fn tan_half_fov(&self, viewport: [u32; 2]) -> [f64; 2] {
        let vertical = (self.fov_degrees.to_radians() * 0.5).tan();
        let aspect = f64::from(viewport[0].max(1)) / f64::from(viewport[1].max(1));
        [vertical * aspect, vertical]
    }

    pub fn view_from_world(&self) -> DMat4 {
        let forward = (self.target - self.eye).normalize_or(DVec3::NEG_Z);
        // Looking straight along `up` leaves the roll open: any other axis decides it.
        let mut right = forward.cross(self.up);
        if right.length() < 1e-9 * self.up.length() {
            right = forward.cross(forward.any_orthogonal_vector());
        }
        let right = right.normalize();
        let up = right.cross(forward);
        let rotation = DMat4::from_cols(
            DVec4::new(right.x, up.x, -forward.x, 0.0),
            DVec4::new(right.y, up.y, -forward.y, 0.0),
            DVec4::new(right.z, up.z, -forward.z, 0.0),
            DVec4::W,
        );
        rotation * DMat4::from_translation(-self.eye)
    }

    /// Reversed infinite depth: `z_clip` is the near distance, `w_clip` the distance ahead.
    pub fn clip_from_view(&self, viewport: [u32; 2]) -> DMat4 {
        let [x, y] = self.tan_half_fov(viewport);
        DMat4::from_cols(
            DVec4::new(1.0 / x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0 / y, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 0.0, -1.0),
            DVec4::new(0.0, 0.0, self.near_m(), 0.0),
        )
    }

    /// The value of a field of [`crate::plan::fields::CAMERA`]. Matrices are 16 numbers, column after column.
    pub fn field(&self, name: &str, viewport: [u32; 2]) -> Option<Value> {
        let view = self.view_from_world();
        let clip = self.clip_from_view(viewport);
        let [tan_x, tan_y] = self.tan_half_fov(viewport);
        Some(match name {
            "clip_from_world" => matrix(clip * view),
            "world_from_clip" => matrix(view.inverse() * clip.inverse()),
            "view_from_world" => matrix(view),
            "world_from_view" => matrix(view.inverse()),
            "clip_from_view" => matrix(clip),
            "view_from_clip" => matrix(clip.inverse()),
            "position" => Value::vec(self.eye.to_array()),
            "near" => Value::Float(self.near_m()),
            "far" => Value::Float(f64::from(f32::MAX)),
            "tan_half_fov" => Value::vec([tan_x, tan_y]),
            "viewport" => Value::vec(viewport.map(f64::from)),
            // Metres that a pixel covers at a distance of one metre.
            "pixel_m" => Value::Float(2.0 * tan_y / f64::from(viewport[1].max(1))),
            "orthographic" => Value::Int(0),
            _ => return None,
        })
    }
}

fn matrix(m: DMat4) -> Value {
    Value::vec(m.to_cols_array())
}

/// A light that is infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The way that its light travels, into the scene; need not be unit.
    pub direction: DVec3,
    /// Linear, unbounded.
    pub color: DVec3,
    /// Irradiance that `color` is scaled by.
    pub intensity: f64,
}

impl Light {
    pub fn fault(&self) -> Option<&'static str> {
        if !self.direction.is_finite() || self.direction.length_squared() == 0.0 {
            Some("a light's direction must be finite and not zero")
        } else if !self.color.is_finite() || !self.intensity.is_finite() {
            Some("a light's color and intensity must be finite")
        } else if self.color.min_element() < 0.0 || self.intensity < 0.0 {
            Some("a light's color and intensity must not be negative")
        } else {
            None
        }
    }

    /// The value of a field of [`crate::plan::fields::LIGHT`]; the direction is unit.
    pub fn field(&self, name: &str) -> Option<Value> {
        Some(match name {
            "direction" => Value::vec(self.direction.normalize_or(DVec3::NEG_Y).to_array()),
            "color" => Value::vec(self.color.to_array()),
            "intensity" => Value::Float(self.intensity),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::fields;

    const SIZE: [u32; 2] = [640, 480];

    fn numbers(value: Option<Value>) -> Vec<f64> {
        let value = value.expect("a field");
        value.numbers().collect()
    }

    fn matrix_of(camera: &Camera, name: &str) -> DMat4 {
        DMat4::from_cols_array(&numbers(camera.field(name, SIZE)).try_into().expect("16 numbers"))
    }

    #[test]
    fn the_target_is_in_the_middle_and_depth_is_reversed() {
        let mut camera = Camera::new(DVec3::new(3.0, 2.0, 5.0), DVec3::new(0.5, 0.25, -1.0), 40.0);
        camera.near_m = Some(0.1);
        let clip_from_world = matrix_of(&camera, "clip_from_world");
        let target = clip_from_world * camera.target.extend(1.0);
        assert!((target.x / target.w).abs() < 1e-12 && (target.y / target.w).abs() < 1e-12);
        assert!((target.w - camera.eye.distance(camera.target)).abs() < 1e-12);
        let forward = (camera.target - camera.eye).normalize();
        let near = clip_from_world * (camera.eye + forward * 0.1).extend(1.0);
        let far = clip_from_world * (camera.eye + forward * 1e6).extend(1.0);
        assert!((near.z / near.w - 1.0).abs() < 1e-9);
        assert!((far.z / far.w).abs() < 1e-6);
    }

    #[test]
    fn each_matrix_has_its_inverse() {
        let camera = Camera::new(DVec3::new(3.0, 2.0, 5.0), DVec3::ZERO, 60.0);
        for (there, back) in [
            ("clip_from_world", "world_from_clip"),
            ("view_from_world", "world_from_view"),
            ("clip_from_view", "view_from_clip"),
        ] {
            let product = matrix_of(&camera, there) * matrix_of(&camera, back);
            assert!(product.abs_diff_eq(DMat4::IDENTITY, 1e-9), "{there}: {product}");
        }
    }

    #[test]
    fn a_pixel_covers_what_pixel_m_says() {
        let camera = Camera::new(DVec3::Z, DVec3::ZERO, 53.13);
        let [_, tan] = camera.tan_half_fov(SIZE);
        let pixel_m = numbers(camera.field("pixel_m", SIZE))[0];
        assert!((pixel_m * 480.0 - 2.0 * tan).abs() < 1e-12);
    }

    #[test]
    fn looking_straight_down_still_has_an_orthonormal_view() {
        let camera = Camera::new(DVec3::new(0.0, 5.0, 0.0), DVec3::ZERO, 40.0);
        let view = camera.view_from_world();
        assert!(view.is_finite());
        assert!((view.determinant() - 1.0).abs() < 1e-12);
        let down = view * DVec4::new(0.0, 0.0, 0.0, 1.0);
        assert!((down.z + 5.0).abs() < 1e-12);
    }

    #[test]
    fn every_listed_field_has_a_value_and_no_other_has() {
        let camera = Camera::new(DVec3::Z, DVec3::ZERO, 40.0);
        assert!(fields::CAMERA.iter().all(|(name, _)| camera.field(name, SIZE).is_some()));
        assert_eq!(camera.field("positions", SIZE), None);
        let light = Light { direction: DVec3::new(0.0, -2.0, 0.0), color: DVec3::ONE, intensity: 3.0 };
        assert!(fields::LIGHT.iter().all(|(name, _)| light.field(name).is_some()));
        assert_eq!(numbers(light.field("direction")), [0.0, -1.0, 0.0]);
    }

    #[test]
    fn cameras_that_cannot_see_are_refused() {
        let good = Camera::new(DVec3::Z, DVec3::ZERO, 40.0);
        assert_eq!(good.fault(), None);
        let bad = [
            Camera { eye: DVec3::ZERO, ..good },
            Camera { eye: DVec3::NAN, ..good },
            Camera { up: DVec3::ZERO, ..good },
            Camera { fov_degrees: 180.0, ..good },
            Camera { fov_degrees: f64::NAN, ..good },
            Camera { near_m: Some(0.0), ..good },
        ];
        assert!(bad.iter().all(|camera| camera.fault().is_some()));
    }
}
