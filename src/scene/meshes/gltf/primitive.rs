//! The triangles of a glTF primitive.

use super::accessor::{Data, Elements};
use super::document;
use super::material::Materials;
use crate::scene::meshes::fill::{self, Raw, Shading};
use crate::scene::meshes::model::Primitive;
use crate::scene::meshes::report::{Report, counted};

/// Reads a primitive; none if it draws no triangles or something is wrong, which is reported.
pub fn read(
    data: &Data<'_>,
    from: &document::Primitive,
    materials: &mut Materials,
    place: &str,
    report: &mut Report,
) -> Option<Primitive> {
    if !from.targets.is_empty() {
        report.warn(place, "morph targets are not read: the mesh stands as it is without them");
    }
    let make: fn(&[u32]) -> Vec<u32> = match from.mode {
        4 => <[u32]>::to_vec,
        5 => triangles_of_strip,
        6 => triangles_of_fan,
        0..=3 => {
            report.warn(place, "points and lines are not drawn");
            return None;
        }
        other => {
            report.error(place, format!("mode {other} is not known; 4 is triangles"));
            return None;
        }
    };
    let Some(position) = from.attributes.get("POSITION") else {
        report.warn(place, "it has no POSITION, and draws nothing");
        return None;
    };
    let positions = data.elements(*position, &["VEC3"], &format!("{place}, POSITION"), report)?;
    let material = materials.index(from.material, place, report)?;
    let corners = corners(data, from, positions.count, place, report)?;
    let mut indices = make(&corners);
    let left = indices.len() % 3;
    if left > 0 {
        let count = counted(left, "index", "indices");
        report.warn(place, format!("{count} left over at the end"));
        indices.truncate(indices.len() - left);
    }
    let used = fill::compact(&mut indices, positions.count);
    let raw = attributes(data, from, &positions, &used, indices, place, report)?;
    fill::finish(raw, Shading::Flat, materials.normal_map(material), material, place, report)
}

/// The vertices in the order in which they are drawn, each below `count`.
fn corners(
    data: &Data<'_>,
    from: &document::Primitive,
    count: usize,
    place: &str,
    report: &mut Report,
) -> Option<Vec<u32>> {
    let place = format!("{place}, indices");
    let Some(accessor) = from.indices else {
        if u32::try_from(count).is_err() || !report.take(count.saturating_mul(4), &place) {
            return None;
        }
        return Some((0..count as u32).collect());
    };
    let elements = data.elements(accessor, &["SCALAR"], &place, report)?;
    if !elements.can_count() {
        report.error(place, "indices must be unsigned whole numbers");
        return None;
    }
    if !report.take(elements.count.saturating_mul(4), &place) {
        return None;
    }
    let mut corners = Vec::with_capacity(elements.count);
    for at in 0..elements.count {
        let index = elements.index(at);
        match u32::try_from(index) {
            Ok(small) if index < count as u64 => corners.push(small),
            _ => {
                let has = counted(count, "vertex", "vertices");
                report.error(place, format!("index {index} at {at}, but there are {has}"));
                return None;
            }
        }
    }
    Some(corners)
}

/// Every second triangle of a strip goes round the other way. Those without area join two strips.
fn triangles_of_strip(corners: &[u32]) -> Vec<u32> {
    let triangles = corners.windows(3).enumerate();
    let turned = triangles.map(|(at, t)| if at % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] });
    turned.filter(|[a, b, c]| a != b && b != c && c != a).flatten().collect()
}

fn triangles_of_fan(corners: &[u32]) -> Vec<u32> {
    let Some((first, rest)) = corners.split_first() else { return Vec::new() };
    rest.windows(2).flat_map(|pair| [pair[0], pair[1], *first]).collect()
}

fn attributes(
    data: &Data<'_>,
    from: &document::Primitive,
    positions: &Elements<'_>,
    used: &[u32],
    indices: Vec<u32>,
    place: &str,
    report: &mut Report,
) -> Option<Raw> {
    if !report.take(used.len().saturating_mul(fill::VERTEX_BYTES), place) {
        return None;
    }
    let mut raw = Raw { positions: gather(positions, used), indices, ..Raw::default() };
    let mut find = |name: &str, shapes: &[&str]| -> Option<Option<Elements<'_>>> {
        let Some(accessor) = from.attributes.get(name) else { return Some(None) };
        let place = format!("{place}, {name}");
        let elements = data.elements(*accessor, shapes, &place, report)?;
        if elements.count != positions.count {
            let (has, wants) = (elements.count, positions.count);
            report.error(place, format!("it has {}, POSITION has {wants}", counted(has, "element", "elements")));
            return None;
        }
        Some(Some(elements))
    };
    raw.normals = find("NORMAL", &["VEC3"])?.map(|e| gather(&e, used));
    raw.tangents = find("TANGENT", &["VEC4"])?.map(|e| gather(&e, used));
    raw.uv0 = find("TEXCOORD_0", &["VEC2"])?.map(|e| gather(&e, used));
    raw.uv1 = find("TEXCOORD_1", &["VEC2"])?.map(|e| gather(&e, used));
    if let Some(colors) = find("COLOR_0", &["VEC3", "VEC4"])? {
        raw.color0 = Some(if colors.width() == 4 {
            gather(&colors, used)
        } else {
            gather::<3>(&colors, used).into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()
        });
    }
    Some(raw)
}

fn gather<const N: usize>(elements: &Elements<'_>, used: &[u32]) -> Vec<[f32; N]> {
    used.iter().map(|index| elements.get(*index as usize)).collect()
}
