//! Surfaces in the formats of simulators: legacy VTK and PLY, as the readers of particles see them.

use glam::Vec3;

use super::bundle::Bundle;
use super::fill::{self, Raw, Shading};
use super::model::{Material, Mesh, Model};
use super::polygon::triangulate;
use super::report::{Report, counted};
use crate::files::Files;
use crate::scene::image::decode_srgb;
use crate::scene::particles::{self, Attribute, Kind, Polygons, Surface};

/// Such files name no others.
pub(super) fn gather(_bundle: &mut Bundle, _files: &dyn Files) {}

pub(super) fn read(bundle: &Bundle, report: &mut Report) -> Option<Model> {
    let surface = match particles::surface(&bundle.path, &bundle.bytes) {
        Ok(surface) => surface,
        Err(error) => {
            match &error.hint {
                Some(hint) => report.error_with_hint("", &error, hint),
                None => report.error("", &error),
            }
            return None;
        }
    };
    say(&surface.polygons, report);
    let mut model = Model::of_one_mesh(Mesh::default());
    model.materials.push(Material::plain());
    let mut indices = triangles(&surface);
    if indices.is_empty() {
        return Some(model);
    }
    let used = fill::compact(&mut indices, surface.positions.len());
    if !report.take(used.len().saturating_mul(fill::VERTEX_BYTES), "") {
        return None;
    }
    let raw = Raw {
        positions: used.iter().map(|index| surface.positions[*index as usize]).collect(),
        normals: find(&surface, &["normal", "normals"], &used),
        uv0: find(&surface, &["uv", "tcoords", "texcoord", "texture_coordinates"], &used),
        color0: colors(&surface, &used),
        indices,
        ..Raw::default()
    };
    model.meshes[0].primitives.extend(fill::finish(raw, Shading::Smooth, None, 0, "", report));
    Some(model)
}

/// Says what of the file is not drawn.
fn say(polygons: &Polygons, report: &mut Report) {
    if polygons.others > 0 {
        report.warn("", format!("left out, being no polygons: {}", counted(polygons.others, "cell", "cells")));
    }
    let small = polygons.iter().filter(|points| points.len() < 3).count();
    if small > 0 {
        let count = counted(small, "polygon", "polygons");
        report.warn("", format!("left out, having less than three corners: {count}"));
    }
}

fn triangles(surface: &Surface) -> Vec<u32> {
    let mut indices = Vec::with_capacity(surface.polygons.corners.len());
    for polygon in surface.polygons.iter() {
        let points: Vec<Vec3> = polygon.iter().map(|at| Vec3::from_array(surface.positions[*at as usize])).collect();
        for triangle in triangulate(&points) {
            let [a, b, c] = triangle.map(|corner| polygon[corner]);
            if a != b && b != c && c != a {
                indices.extend([a, b, c]);
            }
        }
    }
    indices
}

fn attribute<'a>(surface: &'a Surface, names: &[&str]) -> Option<&'a Attribute> {
    surface.attributes.iter().find(|a| names.iter().any(|name| a.name.eq_ignore_ascii_case(name)))
}

/// The rows that are used of an attribute of `N` numbers.
fn find<const N: usize>(surface: &Surface, names: &[&str], used: &[u32]) -> Option<Vec<[f32; N]>> {
    let attribute = attribute(surface, names).filter(|attribute| attribute.components == N)?;
    let values = attribute.to_f32();
    let rows = values.as_chunks::<N>().0;
    used.iter().map(|index| rows.get(*index as usize).copied()).collect()
}

/// Colours, which such files have in sRGB: in bytes, or from 0 to 1.
fn colors(surface: &Surface, used: &[u32]) -> Option<Vec<[f32; 4]>> {
    let names = ["color", "colors", "colour", "rgb", "rgba"];
    let of = attribute(surface, &names)?;
    let one = if of.values.kind() == Kind::U8 { 255.0 } else { 1.0 };
    let light = |x: f32| decode_srgb(f64::from((x / one).clamp(0.0, 1.0))) as f32;
    let rows: Vec<[f32; 4]> = match of.components {
        3 => find::<3>(surface, &names, used)?.into_iter().map(|[r, g, b]| [r, g, b, one]).collect(),
        4 => find::<4>(surface, &names, used)?,
        _ => return None,
    };
    Some(rows.into_iter().map(|[r, g, b, a]| [light(r), light(g), light(b), (a / one).clamp(0.0, 1.0)]).collect())
}
