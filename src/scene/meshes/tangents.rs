//! Tangents for primitives that have none.
//!
//! Normal maps are made for the tangents of MikkTSpace, so a primitive that has one gets those,
//! with its vertices split where two meet. Others get a direction along growing u at each vertex,
//! which is enough for all that is not a normal map.

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3};

use super::fill::direction;
use super::model::Primitive;

/// Along growing u in the plane of each normal; anywhere in it where u does not tell.
pub(super) fn simple(primitive: &Primitive) -> Vec<[f32; 4]> {
    let mut sums = vec![(Vec3::ZERO, Vec3::ZERO); primitive.positions.len()];
    for triangle in primitive.indices.as_chunks::<3>().0 {
        let corner = triangle.map(|index| index as usize);
        let [a, b, c] = corner.map(|at| Vec3::from_array(primitive.positions[at]));
        let [s, t, r] = corner.map(|at| Vec2::from_array(primitive.uv0[at]));
        let (ab, ac, st, sr) = (b - a, c - a, t - s, r - s);
        let sign = if st.perp_dot(sr) < 0.0 { -1.0 } else { 1.0 };
        let along_u = (ab * sr.y - ac * st.y) * sign;
        let along_v = (ac * st.x - ab * sr.x) * sign;
        for at in corner {
            sums[at].0 += along_u;
            sums[at].1 += along_v;
        }
    }
    let vertices = sums.into_iter().zip(&primitive.normals);
    let made = vertices.map(|((along_u, along_v), normal)| {
        let normal = Vec3::from_array(*normal);
        let flat = direction(along_u).map(|u| u - normal * normal.dot(u)).filter(|flat| flat.length() > 1e-3);
        let tangent = flat.and_then(direction).unwrap_or_else(|| normal.any_orthonormal_vector());
        // v grows downwards in a picture, and y of a normal map grows upwards.
        let is_mirrored = normal.cross(tangent).dot(along_v) > 0.0;
        tangent.extend(if is_mirrored { -1.0 } else { 1.0 }).to_array()
    });
    made.collect()
}

/// MikkTSpace's tangents for one of the sets of texture coordinates.
pub(super) fn for_normal_map(primitive: &mut Primitive, uv_set: u32) {
    let fallback = simple(primitive);
    let per_corner: Vec<[f32; 4]> =
        primitive.indices.iter().map(|index| fallback.get(*index as usize).copied().unwrap_or_default()).collect();
    let mut corners = Corners { primitive, uv_set, tangents: per_corner };
    let Ok(()) = generate_tangents(&mut corners) else { return primitive.tangents = fallback };
    let tangents = corners.tangents;
    split(primitive, &tangents);
}

struct Corners<'a> {
    primitive: &'a Primitive,
    uv_set: u32,
    tangents: Vec<[f32; 4]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.primitive.indices[face * 3 + corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.primitive.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.primitive.positions[self.vertex(face, corner)]
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.primitive.normals[self.vertex(face, corner)]
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = if self.uv_set == 1 { &self.primitive.uv1 } else { &self.primitive.uv0 };
        uv[self.vertex(face, corner)]
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        let Some([x, y, z, w]) = tangent.map(|tangent| tangent.tangent_encoded()) else { return };
        let Some(unit) = direction(Vec3::new(x, y, z)) else { return };
        // Its v grows upwards, glTF's downwards.
        self.tangents[face * 3 + corner] = unit.extend(if w < 0.0 { 1.0 } else { -1.0 }).to_array();
    }
}

/// Gives vertices the tangents of their corners: one more vertex for each further tangent.
fn split(primitive: &mut Primitive, tangents: &[[f32; 4]]) {
    let old = std::mem::take(primitive);
    let mut known: HashMap<(u32, [u32; 4]), u32> = HashMap::with_capacity(old.positions.len());
    let mut new = Primitive { material: old.material, ..Primitive::default() };
    for (index, tangent) in old.indices.iter().zip(tangents) {
        let next = new.positions.len() as u32;
        let vertex = *known.entry((*index, tangent.map(f32::to_bits))).or_insert(next);
        if vertex == next {
            let at = *index as usize;
            new.positions.push(old.positions[at]);
            new.normals.push(old.normals[at]);
            new.tangents.push(*tangent);
            new.uv0.push(old.uv0[at]);
            new.uv1.push(old.uv1[at]);
            new.color0.push(old.color0[at]);
        }
        new.indices.push(vertex);
    }
    *primitive = new;
}
