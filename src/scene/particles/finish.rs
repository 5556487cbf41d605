//! From what a reader found to a set: rows that are not finite go, bounds and radius are taken.

use std::borrow::Cow;
use std::collections::HashSet;

use super::error::{ReadError, counted};
use super::parallel;
use super::values::Values;
use super::{Attribute, ParticleSet, Taken};

/// What a reader found in a file.
#[derive(Debug)]
pub(super) struct Found {
    /// Three numbers a row.
    pub position: Values,
    pub attributes: Vec<Attribute>,
    /// Values that the file gives once, with their names; the radius may be among them.
    pub globals: Vec<(String, f64)>,
    pub notes: Vec<String>,
}

impl Found {
    pub fn new(position: Values) -> Self {
        Self { position, attributes: Vec::new(), globals: Vec::new(), notes: Vec::new() }
    }
}

/// The set that a reader's findings make, taken in a scene's way.
pub(super) fn finish(mut found: Found, taken: &Taken) -> Result<ParticleSet, ReadError> {
    taken.rename(&mut found)?;
    let Found { position, attributes, globals, mut notes } = found;
    let position = float_position(position, &mut notes);
    let rows = position.len() / 3;
    let mut attributes = fitting(attributes, rows, &mut notes);
    attributes.insert(0, Attribute { name: "position".to_owned(), components: 3, values: position });
    let radius = radius_of(&globals, &attributes, &mut notes);
    let radius = radius.map(|radius| (f64::from(radius) * taken.placement.scale) as f32).filter(|r| r.is_normal());
    taken.place(&mut attributes);

    let dropped = drop_rows(&mut attributes, rows);
    if dropped > 0 {
        notes.push(format!("dropped {dropped} of {} whose position is not finite", counted(rows, "particle")));
    }
    let count = rows - dropped;
    if count == 0 {
        notes.push(if rows == 0 { "the file has no particles".to_owned() } else { "no particles are left".to_owned() });
    }
    let (min, max) = bounds(&triples(&attributes[0].values));
    Ok(ParticleSet { attributes, count, dropped, radius, min, max, notes })
}

/// Positions of whole numbers become `f64`, which holds them all.
fn float_position(position: Values, notes: &mut Vec<String>) -> Values {
    let kind = position.kind();
    if kind.is_float() {
        return position;
    }
    notes.push(format!("positions of type {} were taken as f64", kind.name()));
    Values::F64(position.to_f64())
}

/// The attributes that have a name of their own and a row for each particle.
fn fitting(found: Vec<Attribute>, rows: usize, notes: &mut Vec<String>) -> Vec<Attribute> {
    let mut kept: Vec<Attribute> = Vec::with_capacity(found.len() + 1);
    let mut names = HashSet::from(["position".to_owned()]);
    for attribute in found {
        let name = &attribute.name;
        if !names.insert(name.clone()) {
            notes.push(format!("a second attribute named `{name}` is left out"));
        } else if rows.checked_mul(attribute.components) != Some(attribute.values.len()) || attribute.components == 0 {
            notes.push(format!("attribute `{name}` is left out: it does not have a row for each particle"));
        } else {
            kept.push(attribute);
        }
    }
    kept
}

/// The radius that the file gives, once or alike for all particles.
fn radius_of(globals: &[(String, f64)], attributes: &[Attribute], notes: &mut Vec<String>) -> Option<f32> {
    let global = globals.iter().find(|(name, _)| names_radius(name)).map(|(name, value)| (name, Some(*value)));
    let of_rows = || {
        let attribute = attributes.iter().find(|a| a.components == 1 && names_radius(&a.name))?;
        (!attribute.values.is_empty()).then(|| (&attribute.name, attribute.values.uniform()))
    };
    let (name, value) = global.or_else(of_rows)?;
    let Some(value) = value else {
        notes.push(format!("`{name}` differs between particles, so it is not taken as the radius of all"));
        return None;
    };
    let radius = value as f32;
    if radius.is_finite() && radius > 0.0 {
        return Some(radius);
    }
    notes.push(format!("`{name}` is {value}, which is no radius, and is not taken"));
    None
}

/// Whether a value of this name is a radius.
pub(super) fn names_radius(name: &str) -> bool {
    const NAMES: &[&str] = &["radius", "particleradius", "pscale"];
    let plain: String = name.chars().filter(|c| c.is_alphanumeric()).collect();
    NAMES.iter().any(|n| plain.eq_ignore_ascii_case(n))
}

/// The positions as `f32`, without a copy where they are.
pub(super) fn triples(values: &Values) -> Cow<'_, [[f32; 3]]> {
    match values {
        Values::F32(v) => Cow::Borrowed(v.as_chunks().0),
        other => Cow::Owned(other.to_f32().as_chunks().0.to_vec()),
    }
}

/// Removes rows whose position is not finite as `f32` from everything; tells how many.
fn drop_rows(attributes: &mut [Attribute], rows: usize) -> usize {
    let keep = {
        let xyz = triples(&attributes[0].values);
        let finite = |p: &[f32; 3]| p.iter().all(|v| v.is_finite());
        if parallel::looked_at(&xyz, 3, |part| part.iter().all(finite)).into_iter().all(|all| all) {
            return 0;
        }
        xyz.iter().map(finite).collect::<Vec<bool>>()
    };
    for attribute in attributes {
        attribute.values.retain_rows(&keep, attribute.components);
    }
    rows - keep.iter().filter(|keep| **keep).count()
}

fn bounds(xyz: &[[f32; 3]]) -> ([f32; 3], [f32; 3]) {
    let Some(&first) = xyz.first() else { return ([0.0; 3], [0.0; 3]) };
    let wider = |a: ([f32; 3], [f32; 3]), b: ([f32; 3], [f32; 3])| {
        let low: [f32; 3] = std::array::from_fn(|axis| a.0[axis].min(b.0[axis]));
        (low, std::array::from_fn(|axis| a.1[axis].max(b.1[axis])))
    };
    let parts = parallel::looked_at(xyz, 3, |part| part.iter().fold((first, first), |all, p| wider(all, (*p, *p))));
    parts.into_iter().fold((first, first), wider)
}
