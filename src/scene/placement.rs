//! Where the numbers of a file stand in the scene, whose unit is the metre and whose y is up.

use glam::{DMat3, DVec3};

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    #[default]
    Y,
    Z,
}

impl Up {
    pub const WORDS: &[(&str, Self)] = &[("Y", Self::Y), ("Z", Self::Z)];

    /// Turns what points up in the file up in the scene. With z up, x stays and what is along y goes away from the
    /// viewer, along -z.
    pub fn scene_from_file(self) -> DMat3 {
        match self {
            Self::Y => DMat3::IDENTITY,
            Self::Z => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        }
    }
}

/// `position + turn * scale * p` for a place p of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Metres to a unit of the file; above 0.
    pub scale: f64,
    /// A rotation.
    pub turn: DMat3,
    /// Metres.
    pub position: DVec3,
}

impl Default for Placement {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Placement {
    pub const IDENTITY: Self = Self { scale: 1.0, turn: DMat3::IDENTITY, position: DVec3::ZERO };

    /// A file with another axis up and another unit.
    pub fn of_file(up: Up, scale: f64) -> Self {
        Self { scale, turn: up.scene_from_file(), ..Self::IDENTITY }
    }

    pub fn place(&self, p: DVec3) -> DVec3 {
        self.position + self.turn * (self.scale * p)
    }

    /// A length, a speed and other things that have a length and a direction, but no place.
    pub fn lengthen(&self, v: DVec3) -> DVec3 {
        self.turn * (self.scale * v)
    }

    /// What is a direction only.
    pub fn turn(&self, v: DVec3) -> DVec3 {
        self.turn * v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn z_becomes_up_and_nothing_is_mirrored() {
        let placement = Placement::of_file(Up::Z, 0.001);
        assert_eq!(placement.place(DVec3::new(1000.0, 2000.0, 3000.0)), DVec3::new(1.0, 3.0, -2.0));
        assert_eq!(placement.turn(DVec3::Z), DVec3::Y);
        assert_eq!(placement.turn.determinant(), 1.0);
    }
}
