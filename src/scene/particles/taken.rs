//! What a scene says of a file's numbers: what they are called there, and where they stand.

use glam::DVec3;

use super::Attribute;
use super::error::ReadError;
use super::finish::{Found, names_radius};
use super::parallel;
use super::values::Values;
use crate::diagnostic::nearest;
use crate::scene::placement::Placement;

/// How a file is taken.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Taken {
    pub placement: Placement,
    /// Attributes that get another name: the new one, and the file's.
    pub names: Vec<(String, String)>,
}

impl Taken {
    /// Gives attributes their new names.
    ///
    /// # Errors
    /// If the file has no such attribute.
    pub(super) fn rename(&self, found: &mut Found) -> Result<(), ReadError> {
        let place_of = |name: &str| found.attributes.iter().position(|a| a.name == name);
        let places: Vec<_> = self.names.iter().map(|(_, old)| place_of(old)).collect();
        for ((new, old), place) in self.names.iter().zip(places) {
            let Some(place) = place else { return Err(lacks(old, &found.attributes)) };
            // What bears the new name already goes on without one that a shader asks for.
            if let Some(other) = found.attributes.iter_mut().find(|a| a.name == *new) {
                other.name = format!("{new} of the file");
            }
            found.attributes[place].name.clone_from(new);
        }
        Ok(())
    }

    /// Puts positions where the scene has them, and turns and scales what goes along with them.
    pub(super) fn place(&self, attributes: &mut [Attribute]) {
        let placement = self.placement;
        if placement == Placement::IDENTITY {
            return;
        }
        for attribute in attributes {
            match (attribute.components, meaning(&attribute.name)) {
                (3, Some(Meaning::Place)) => change(&mut attribute.values, |v| placement.place(v)),
                (3, Some(Meaning::Length)) => change(&mut attribute.values, |v| placement.lengthen(v)),
                (3, Some(Meaning::Direction)) => change(&mut attribute.values, |v| placement.turn(v)),
                (1, _) if names_radius(&attribute.name) => scale(&mut attribute.values, placement.scale),
                _ => {}
            }
        }
    }
}

fn lacks(name: &str, attributes: &[Attribute]) -> ReadError {
    let names: Vec<&str> = attributes.iter().map(|a| a.name.as_str()).collect();
    let error = ReadError::new(format!("there is no attribute `{name}`"));
    match nearest(name, names.iter().copied()) {
        Some(near) => error.hint(format!("did you mean `{near}`?")),
        None if names.is_empty() => error.hint("the file has positions only"),
        None => error.hint(format!("there are {}", names.join(", "))),
    }
}

/// What three numbers of a particle are.
enum Meaning {
    Place,
    Length,
    Direction,
}

fn meaning(name: &str) -> Option<Meaning> {
    const LENGTHS: &[&str] = &["velocity", "velocities", "vel", "v", "acceleration", "accel", "displacement"];
    const DIRECTIONS: &[&str] = &["normal", "normals", "n", "vorticity", "angularvelocity"];
    let plain: String = name.chars().filter(|c| c.is_alphanumeric()).collect();
    let is_one_of = |names: &[&str]| names.iter().any(|n| plain.eq_ignore_ascii_case(n));
    match name {
        "position" => Some(Meaning::Place),
        _ if is_one_of(LENGTHS) => Some(Meaning::Length),
        _ if is_one_of(DIRECTIONS) => Some(Meaning::Direction),
        _ => None,
    }
}

/// Changes rows of three floats, in their own width.
fn change(values: &mut Values, by: impl Fn(DVec3) -> DVec3 + Sync) {
    match values {
        Values::F32(all) => {
            let rows = all.as_chunks::<3>().0;
            let fill = |first: usize, out: &mut [f32]| {
                let new =
                    rows[first..].iter().map(|row| by(DVec3::from_array(row.map(f64::from))).as_vec3().to_array());
                out.as_chunks_mut::<3>().0.iter_mut().zip(new).for_each(|(out, new)| *out = new);
            };
            *all = parallel::filled(rows.len(), 3, fill);
        }
        other => {
            let mut all = std::mem::replace(other, Values::F64(Vec::new())).to_f64();
            all.as_chunks_mut::<3>().0.iter_mut().for_each(|row| *row = by(DVec3::from_array(*row)).to_array());
            *other = Values::F64(all);
        }
    }
}

fn scale(values: &mut Values, by: f64) {
    match values {
        Values::F32(all) => all.iter_mut().for_each(|x| *x = (f64::from(*x) * by) as f32),
        other => *other = Values::F64(other.to_f64().into_iter().map(|x| x * by).collect()),
    }
}
