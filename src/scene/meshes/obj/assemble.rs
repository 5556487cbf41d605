//! From statements to primitives: a primitive for each material, a vertex for each combination of
//! parts that occurs.

use std::collections::{BTreeMap, HashMap};

use glam::Vec3;

use super::mtl::Materials;
use super::statements::{Corner, Statements};
use crate::scene::image::decode_srgb;
use crate::scene::meshes::fill::{self, Raw, Shading};
use crate::scene::meshes::model::{Mesh, Model};
use crate::scene::meshes::polygon::triangulate;
use crate::scene::meshes::report::{Report, shown};

/// A triangle of a face: three places in the list of corners.
struct Triangle {
    corners: [usize; 3],
    material: Option<usize>,
}

pub fn model(from: &Statements, mut materials: Materials, report: &mut Report) -> Option<Model> {
    if !report.take(from.corners.len().saturating_mul(fill::VERTEX_BYTES), "") {
        return None;
    }
    let triangles = triangles(from);
    let made = Normals::make(from, &triangles);
    let mut by_material: BTreeMap<Option<usize>, Vec<&Triangle>> = BTreeMap::new();
    triangles.iter().for_each(|triangle| by_material.entry(triangle.material).or_default().push(triangle));
    let mut primitives = Vec::new();
    for (number, triangles) in by_material {
        let name = number.and_then(|number| from.materials.get(number)).map(|(line, name)| (*line, name.as_str()));
        let material = materials.index(name, report);
        let place = name.map_or_else(String::new, |(_, name)| format!("material {}", shown(name)));
        let raw = gather(from, &triangles, &made);
        let map = materials.normal_map(material);
        primitives.extend(fill::finish(raw, Shading::Smooth, map, material, &place, report));
    }
    let mut model = Model::of_one_mesh(Mesh { name: String::new(), primitives });
    (model.materials, model.images) = materials.finish();
    Some(model)
}

fn triangles(from: &Statements) -> Vec<Triangle> {
    let mut triangles = Vec::with_capacity(from.corners.len());
    for face in &from.faces {
        let corners = from.corners.get(face.start..face.start + face.count).unwrap_or_default();
        let points: Vec<Vec3> = corners.iter().map(|c| Vec3::from_array(from.positions[c.position as usize])).collect();
        for triangle in triangulate(&points) {
            let [a, b, c] = triangle.map(|corner| corners[corner].position);
            // What a repeated corner makes has no area and would tell no normal.
            if a != b && b != c && c != a {
                let corners = triangle.map(|corner| face.start + corner);
                triangles.push(Triangle { corners, material: face.material });
            }
        }
    }
    triangles
}

/// Normals for corners that have none. Corners at one position in one smoothing group share one.
struct Normals {
    /// Which normal each corner of the file has; those that need none have any.
    of_corner: Vec<u32>,
    values: Vec<[f32; 3]>,
}

impl Normals {
    fn make(from: &Statements, triangles: &[Triangle]) -> Self {
        let mut of_corner = vec![0; from.corners.len()];
        let mut positions = Vec::new();
        let mut known: HashMap<(u32, u64), u32> = HashMap::new();
        for (number, face) in from.faces.iter().enumerate() {
            // A flat face is a group of its own.
            let group = face.smoothing.map_or(number as u64 | 1 << 63, u64::from);
            let range = face.start..face.start + face.count;
            for (corner, made) in from.corners[range.clone()].iter().zip(&mut of_corner[range]) {
                if corner.normal.is_none() {
                    *made = *known.entry((corner.position, group)).or_insert_with(|| {
                        positions.push(from.positions[corner.position as usize]);
                        positions.len() as u32 - 1
                    });
                }
            }
        }
        let without = triangles.iter().filter(|t| t.corners.iter().all(|at| from.corners[*at].normal.is_none()));
        let indices: Vec<u32> = without.flat_map(|t| t.corners.map(|at| of_corner[at])).collect();
        Self { values: fill::smooth_normals(&positions, &indices), of_corner }
    }
}

/// The triangles of one material with vertices of their own.
fn gather(from: &Statements, triangles: &[&Triangle], made: &Normals) -> Raw {
    let mut known: HashMap<(u32, Option<u32>, Option<u32>, u32), u32> = HashMap::new();
    let mut raw = Raw::default();
    let (mut normals, mut uvs, mut colors) = (Vec::new(), Vec::new(), Vec::new());
    for at in triangles.iter().flat_map(|triangle| triangle.corners) {
        let Corner { position, uv, normal } = from.corners[at];
        let made_normal = if normal.is_some() { 0 } else { made.of_corner[at] };
        let next = raw.positions.len() as u32;
        let vertex = *known.entry((position, uv, normal, made_normal)).or_insert(next);
        raw.indices.push(vertex);
        if vertex < next {
            continue;
        }
        raw.positions.push(from.positions[position as usize]);
        normals.push(match normal {
            Some(normal) => from.normals[normal as usize],
            None => made.values[made_normal as usize],
        });
        // Rows of a picture count from the top here, from the bottom in OBJ.
        uvs.push(uv.map_or([0.0; 2], |uv| {
            let [u, v] = from.uvs[uv as usize];
            [u, 1.0 - v]
        }));
        if let Some(color) = from.colors.get(position as usize) {
            let [r, g, b] = color.map(|x| decode_srgb(f64::from(x.clamp(0.0, 1.0))) as f32);
            colors.push([r, g, b, 1.0]);
        }
    }
    raw.normals = Some(normals);
    raw.uv0 = Some(uvs);
    raw.color0 = (!colors.is_empty()).then_some(colors);
    raw
}
