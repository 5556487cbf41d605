//! The sun by place and time: where it stands, and what comes of its light through the air.

use glam::DVec3;

use super::camera::Light;

/// When and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Solar time in hours: 12 is when it stands highest.
    pub time_h: f64,
    /// Degrees north of the equator.
    pub latitude: f64,
    /// Of the year; 172 is the longest in the north.
    pub day: f64,
    /// Degrees by which north is turned from -z towards +x.
    pub north: f64,
    /// Irradiance at noon overhead.
    pub intensity: f64,
}

/// What of each colour comes down through air of one atmosphere: the sun overhead is nearly white.
const THROUGH_AIR: DVec3 = DVec3::new(0.945, 0.885, 0.775);
/// Its light without air, so that the sun overhead brings the intensity.
const ABOVE_AIR: DVec3 = DVec3::new(1.06, 1.06, 1.06);

impl Default for Sun {
    fn default() -> Self {
        Self { time_h: 12.0, latitude: 45.0, day: 172.0, north: 0.0, intensity: 4.0 }
    }
}

impl Sun {
    pub fn fault(&self) -> Option<&'static str> {
        let Self { time_h, latitude, day, north, intensity } = *self;
        if !(0.0..=24.0).contains(&time_h) {
            Some("a time is 0 to 24 hours")
        } else if !(-90.0..=90.0).contains(&latitude) {
            Some("a latitude is -90 to 90 degrees")
        } else if !(0.0..=366.0).contains(&day) {
            Some("a day of the year is 0 to 366")
        } else if !north.is_finite() || !intensity.is_finite() || intensity < 0.0 {
            Some("`north` must be finite, and `intensity` not below 0")
        } else {
            None
        }
    }

    /// Unit vector towards the sun: x east and -z north, unless `north` turns them; y is up.
    pub fn towards(&self) -> DVec3 {
        let declination = 23.44_f64.to_radians() * ((284.0 + self.day) / 365.0 * std::f64::consts::TAU).sin();
        let hour = ((self.time_h - 12.0) * 15.0).to_radians();
        let latitude = self.latitude.to_radians();
        let up = latitude.sin() * declination.sin() + latitude.cos() * declination.cos() * hour.cos();
        let east = -declination.cos() * hour.sin();
        let north = latitude.cos() * declination.sin() - latitude.sin() * declination.cos() * hour.cos();
        let (sin, cos) = self.north.to_radians().sin_cos();
        DVec3::new(east * cos + north * sin, up, east * sin - north * cos).normalize_or(DVec3::Y)
    }

    /// The light that comes down: less and redder the lower the sun stands, none when it is down.
    pub fn light(&self) -> Light {
        let towards = self.towards();
        let height_deg = towards.y.asin().to_degrees();
        // Masses of air on the way (Kasten and Young 1989).
        let above = height_deg.max(-0.5);
        let masses = 1.0 / (above.to_radians().sin().max(0.0) + 0.505_72 * (above + 6.079_95).powf(-1.636_4));
        let color =
            ABOVE_AIR * DVec3::new(THROUGH_AIR.x.powf(masses), THROUGH_AIR.y.powf(masses), THROUGH_AIR.z.powf(masses));
        // The disc goes down over half a degree to either side.
        let risen = ((height_deg + 0.5) / 1.0).clamp(0.0, 1.0);
        Light { direction: -towards, color, intensity: self.intensity * risen }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time_h: f64) -> Sun {
        Sun { time_h, ..Sun::default() }
    }

    #[test]
    fn it_rises_in_the_east_and_stands_in_the_south_at_noon() {
        let (morning, noon, evening) = (at(7.0).towards(), at(12.0).towards(), at(17.0).towards());
        assert!(morning.x > 0.5 && evening.x < -0.5 && morning.y > 0.0);
        assert!(noon.x.abs() < 1e-12 && noon.z > 0.0, "{noon}: -z is north");
        // 90° less the latitude, and the tilt of the longest day.
        assert!((noon.y.asin().to_degrees() - (45.0 + 23.44)).abs() < 0.1);
        assert!(at(0.0).towards().y < 0.0, "it is down at midnight");
        let turned = Sun { north: 90.0, ..at(12.0) }.towards();
        assert!(turned.x < -0.3 && turned.z.abs() < 1e-12, "north at +x puts the south at -x: {turned}");
    }

    #[test]
    fn the_equator_has_it_overhead_when_day_and_night_are_equal() {
        let sun = Sun { latitude: 0.0, day: 81.0, ..at(12.0) };
        assert!(sun.towards().y > 0.9999);
        let light = sun.light();
        assert!((light.color.x - 1.0).abs() < 0.01 && (light.intensity - 4.0).abs() < 1e-9);
    }

    #[test]
    fn it_reddens_and_fades_towards_the_horizon() {
        let lights: Vec<Light> = [12.0, 17.0, 19.0, 19.5].map(|time_h| at(time_h).light()).to_vec();
        for pair in lights.windows(2) {
            let [higher, lower] = pair else { continue };
            assert!(lower.color.max_element() < higher.color.max_element());
            assert!(lower.color.z / lower.color.x < higher.color.z / higher.color.x);
        }
        assert_eq!(at(22.0).light().intensity, 0.0);
        assert!(lights.iter().all(|light| light.fault().is_none()) && at(0.0).light().fault().is_none());
    }

    #[test]
    fn what_cannot_be_is_told() {
        assert!(at(25.0).fault().is_some() && Sun { latitude: 91.0, ..at(1.0) }.fault().is_some());
        assert_eq!(Sun::default().fault(), None);
    }
}
