//! Where somebody points over time, in world space: authored in a scene, or recorded in a window.

use glam::DVec3;

use crate::graph::value::Value;

/// A ray under the pointer from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointing {
    /// Seconds since the start.
    pub time_s: f64,
    pub origin: DVec3,
    /// Need not be unit.
    pub direction: DVec3,
    pub is_pressed: bool,
}

/// Rays in the order of their times. What steps see of it is that of the step's own time, so that it
/// is the same however often pictures are drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointerPath {
    keys: Vec<Pointing>,
    /// Between two keys the ray goes from one to the other, as in authored paths; else the earlier one
    /// holds, as in recordings.
    goes_between: bool,
}

impl Pointing {
    /// What keeps it from being a ray, if anything does.
    pub fn fault(&self) -> Option<&'static str> {
        if !(self.origin.is_finite() && self.direction.is_finite() && self.time_s.is_finite()) {
            Some("a pointer's time, origin and direction must be finite")
        } else if self.direction.length_squared() == 0.0 {
            Some("a pointer's direction must not be zero")
        } else {
            None
        }
    }

    /// Before anybody pointed: straight down at the origin, not pressed.
    fn nowhere() -> Self {
        Self { time_s: 0.0, origin: DVec3::ZERO, direction: DVec3::NEG_Y, is_pressed: false }
    }
}

impl PointerPath {
    /// A path that goes from key to key. The times must rise.
    pub fn authored(keys: Vec<Pointing>) -> Self {
        Self { keys, goes_between: true }
    }

    /// One ray for all times, pressed.
    pub fn held(origin: DVec3, direction: DVec3) -> Self {
        Self { keys: vec![Pointing { time_s: 0.0, origin, direction, is_pressed: true }], goes_between: false }
    }

    /// Adds what is pointed at from a time on, and forgets what was recorded for later times.
    pub fn record(&mut self, key: Pointing) {
        let before = self.keys.partition_point(|known| known.time_s < key.time_s);
        self.keys.truncate(before);
        self.keys.push(key);
    }

    /// Whether nobody ever pointed.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// What is pointed at, at a time.
    pub fn at(&self, time_s: f64) -> Pointing {
        let next = self.keys.partition_point(|key| key.time_s <= time_s);
        let (Some(now), then) = (next.checked_sub(1).and_then(|i| self.keys.get(i)), self.keys.get(next)) else {
            return self.keys.first().map_or_else(Pointing::nowhere, |first| Pointing { is_pressed: false, ..*first });
        };
        match then.filter(|_| self.goes_between) {
            Some(then) => {
                let share = (time_s - now.time_s) / (then.time_s - now.time_s);
                let origin = now.origin.lerp(then.origin, share);
                Pointing { origin, direction: now.direction.lerp(then.direction, share), ..*now }
            }
            None => *now,
        }
    }

    /// A field of a pointer at a time, as graphs see it.
    pub fn field(&self, field: &str, time_s: f64) -> Option<Value> {
        let now = self.at(time_s);
        match field {
            "origin" => Some(Value::vec(now.origin.to_array())),
            "direction" => Some(Value::vec(now.direction.normalize_or(DVec3::NEG_Y).to_array())),
            "pressed" => Some(Value::Int(now.is_pressed.into())),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(time_s: f64, x: f64, is_pressed: bool) -> Pointing {
        Pointing { time_s, origin: DVec3::new(x, 1.0, 0.0), direction: DVec3::NEG_Y, is_pressed }
    }

    #[test]
    fn authored_paths_go_from_key_to_key() {
        let path = PointerPath::authored(vec![key(1.0, 0.0, true), key(3.0, 4.0, false)]);
        assert_eq!((path.at(2.0).origin.x, path.at(2.0).is_pressed), (2.0, true));
        assert_eq!((path.at(5.0).origin.x, path.at(5.0).is_pressed), (4.0, false));
        assert_eq!((path.at(0.5).origin.x, path.at(0.5).is_pressed), (0.0, false));
        assert_eq!(PointerPath::default().field("pressed", 1.0), Some(Value::Int(0)));
    }

    #[test]
    fn recordings_hold_and_are_written_over() {
        let mut path = PointerPath::default();
        for (time_s, x) in [(0.0, 1.0), (1.0, 2.0), (2.0, 3.0)] {
            path.record(key(time_s, x, true));
        }
        assert_eq!(path.at(1.9).origin.x, 2.0);
        path.record(key(1.5, 9.0, false));
        assert_eq!((path.at(9.0).origin.x, path.at(1.4).origin.x), (9.0, 2.0));
    }
}
