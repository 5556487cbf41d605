//! From what a file gives of a primitive to all attributes: normals and tangents are made where
//! there are none or where they are no directions.

use glam::Vec3;

use super::model::Primitive;
use super::report::{Report, counted};
use super::tangents;

/// What a file gives of a primitive. Attributes that are there have the length of `positions`,
/// indices are below it and a multiple of three.
#[derive(Debug, Default)]
pub(super) struct Raw {
    pub positions: Vec<[f32; 3]>,
    pub normals: Option<Vec<[f32; 3]>>,
    pub tangents: Option<Vec<[f32; 4]>>,
    pub uv0: Option<Vec<[f32; 2]>>,
    pub uv1: Option<Vec<[f32; 2]>>,
    pub color0: Option<Vec<[f32; 4]>>,
    pub indices: Vec<u32>,
}

/// How normals are made where a file has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shading {
    /// Each triangle has its own.
    Flat,
    /// Triangles that share a vertex share its normal.
    Smooth,
}

/// Bytes of a vertex with all attributes.
pub(super) const VERTEX_BYTES: usize = 72;

/// Fills a primitive. `normal_map` is the set of texture coordinates of its normal texture.
/// None if positions are not finite or nothing is drawn, which is reported.
pub(super) fn finish(
    mut raw: Raw,
    shading: Shading,
    normal_map: Option<u32>,
    material: usize,
    place: &str,
    report: &mut Report,
) -> Option<Primitive> {
    if let Some(at) = raw.positions.iter().position(|p| !is_finite(p)) {
        report.error(place, format!("the position of vertex {at} is not finite"));
        return None;
    }
    if raw.indices.is_empty() {
        report.warn(place, "it has no triangles");
        return None;
    }
    clean(&mut raw, place, report);
    if raw.normals.is_none() {
        // Tangents without normals say nothing.
        raw.tangents = None;
        match shading {
            Shading::Smooth => raw.normals = Some(smooth_normals(&raw.positions, &raw.indices)),
            Shading::Flat => {
                if !report.take(raw.indices.len().saturating_mul(VERTEX_BYTES), place) {
                    return None;
                }
                flatten(&mut raw);
            }
        }
    }
    let count = raw.positions.len();
    let mut primitive = Primitive {
        positions: raw.positions,
        normals: raw.normals.unwrap_or_default(),
        tangents: Vec::new(),
        uv0: raw.uv0.unwrap_or_else(|| vec![[0.0; 2]; count]),
        uv1: raw.uv1.unwrap_or_else(|| vec![[0.0; 2]; count]),
        color0: raw.color0.unwrap_or_else(|| vec![[1.0; 4]; count]),
        indices: raw.indices,
        material,
    };
    match (raw.tangents, normal_map) {
        (Some(tangents), _) => primitive.tangents = tangents,
        (None, None) => primitive.tangents = tangents::simple(&primitive),
        (None, Some(uv_set)) => {
            if !report.take(primitive.indices.len().saturating_mul(VERTEX_BYTES), place) {
                return None;
            }
            tangents::for_normal_map(&mut primitive, uv_set);
        }
    }
    Some(primitive)
}

/// Renumbers indices so that only vertices that are used remain; gives those, in order. Files
/// often have one array of vertices for many primitives.
pub(super) fn compact(indices: &mut [u32], count: usize) -> Vec<u32> {
    let mut used = indices.to_vec();
    used.sort_unstable();
    used.dedup();
    if used.len() < count {
        for index in indices {
            *index = used.binary_search(index).unwrap_or(0) as u32;
        }
    }
    used
}

fn is_finite(numbers: &[f32]) -> bool {
    numbers.iter().all(|x| x.is_finite())
}

/// Makes whole what is not finite or has no length, and says so.
fn clean(raw: &mut Raw, place: &str, report: &mut Report) {
    let mut say = |bad: usize, what: &str, taken: &str| {
        if bad > 0 {
            let count = counted(bad, what, &format!("{what}s"));
            report.warn(place, format!("{count} with numbers that cannot be used: {taken}"));
        }
    };
    if let Some(normals) = &mut raw.normals {
        let bad = normalize(normals);
        if !bad.is_empty() {
            let made = smooth_normals(&raw.positions, &raw.indices);
            bad.iter().for_each(|&at| normals[at] = made[at]);
        }
        say(bad.len(), "normal", "made from the triangles around");
    }
    if let Some(tangents) = &mut raw.tangents {
        let bad = tangents.iter_mut().map(unit_tangent).filter(|is_whole| !is_whole).count();
        say(bad, "tangent", "all tangents are made anew");
        if bad > 0 {
            raw.tangents = None;
        }
    }
    for uv in [&mut raw.uv0, &mut raw.uv1].into_iter().flatten() {
        say(replace(uv, [0.0; 2]), "texture coordinate", "0 is taken");
    }
    if let Some(colors) = &mut raw.color0 {
        say(replace(colors, [1.0; 4]), "colour", "white is taken");
    }
}

/// Puts `usual` in the place of rows that are not finite; tells how many there were.
fn replace<const N: usize>(rows: &mut [[f32; N]], usual: [f32; N]) -> usize {
    let bad = rows.iter_mut().filter(|row| !is_finite(*row));
    bad.map(|row| *row = usual).count()
}

/// Gives all normals the length 1; tells which have no direction.
fn normalize(normals: &mut [[f32; 3]]) -> Vec<usize> {
    let mut bad = Vec::new();
    for (at, normal) in normals.iter_mut().enumerate() {
        match direction(Vec3::from_array(*normal)) {
            Some(unit) => *normal = unit.to_array(),
            None => bad.push(at),
        }
    }
    bad
}

fn unit_tangent(tangent: &mut [f32; 4]) -> bool {
    let [x, y, z, w] = *tangent;
    let Some(unit) = direction(Vec3::new(x, y, z)).filter(|_| w.is_finite()) else { return false };
    *tangent = [unit.x, unit.y, unit.z, if w < 0.0 { -1.0 } else { 1.0 }];
    true
}

/// The vector of length 1 along `v`, if it has a direction.
pub(super) fn direction(v: Vec3) -> Option<Vec3> {
    // In f64, since squares of small and of large numbers leave the range of f32.
    let v = v.as_dvec3();
    let length = v.length();
    (length > 1e-30 && length.is_finite()).then(|| (v / length).as_vec3())
}

fn corners(positions: &[[f32; 3]], triangle: &[u32]) -> [Vec3; 3] {
    std::array::from_fn(|corner| Vec3::from_array(positions[triangle[corner] as usize]))
}

/// Perpendicular to a triangle, along its front; its length is of no account.
fn perpendicular([a, b, c]: [Vec3; 3]) -> Vec3 {
    let (ab, ac) = (b.as_dvec3() - a.as_dvec3(), c.as_dvec3() - a.as_dvec3());
    let perpendicular = ab.cross(ac);
    let length = perpendicular.length();
    if length > 0.0 && length.is_finite() { (perpendicular / length).as_vec3() } else { Vec3::ZERO }
}

/// A normal for each vertex: those of the triangles around it, weighted by their angle there, so
/// that it does not matter how a surface is cut into triangles.
pub(super) fn smooth_normals(positions: &[[f32; 3]], indices: &[u32]) -> Vec<[f32; 3]> {
    let mut sums = vec![Vec3::ZERO; positions.len()];
    for triangle in indices.as_chunks::<3>().0 {
        let points = corners(positions, triangle);
        let normal = perpendicular(points);
        for corner in 0..3 {
            let to = |other: usize| direction(points[(corner + other) % 3] - points[corner]);
            let angle = to(1).zip(to(2)).map_or(0.0, |(p, q)| p.dot(q).clamp(-1.0, 1.0).acos());
            sums[triangle[corner] as usize] += normal * angle;
        }
    }
    sums.into_iter().map(|sum| direction(sum).unwrap_or(Vec3::Y).to_array()).collect()
}

/// Gives each triangle vertices and a normal of its own.
fn flatten(raw: &mut Raw) {
    fn spread<T: Copy>(values: &mut Vec<T>, indices: &[u32]) {
        *values = indices.iter().map(|index| values[*index as usize]).collect();
    }
    let indices = std::mem::take(&mut raw.indices);
    spread(&mut raw.positions, &indices);
    raw.uv0.iter_mut().for_each(|uv| spread(uv, &indices));
    raw.uv1.iter_mut().for_each(|uv| spread(uv, &indices));
    raw.color0.iter_mut().for_each(|color| spread(color, &indices));
    raw.indices = (0..indices.len() as u32).collect();
    let triangles = raw.indices.as_chunks::<3>().0.iter();
    let normals = triangles.flat_map(|triangle| {
        let normal = direction(perpendicular(corners(&raw.positions, triangle))).unwrap_or(Vec3::Y);
        [normal.to_array(); 3]
    });
    raw.normals = Some(normals.collect());
}
