//! glTF 2.0, as JSON with files beside it, with data in it, and as one binary file.
//!
//! The document is read by structures of our own, since the crates for it index without checking,
//! refuse files that the specification allows, and cut numbers off.

mod accessor;
mod animation;
mod container;
mod document;
mod material;
mod nodes;
mod primitive;

use crate::files::Files;

use super::bundle::Bundle;
use super::model::{Mesh, Model};
use super::report::{Report, counted, shown};
use accessor::Data;
use container::{Address, Container};
use document::{Document, Head, References};

/// Extensions that a file may require.
const SUPPORTED: &[&str] = &[
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Fetches the files that a document names.
pub(super) fn gather(bundle: &mut Bundle, files: &dyn Files) {
    let bytes = bundle.bytes.clone();
    let Ok(Container { json, .. }) = container::open(&bytes) else { return };
    let Ok(references) = serde_json::from_slice::<References>(json) else { return };
    for uri in references.buffers.iter().chain(&references.images).filter_map(|r| r.uri.as_deref()) {
        if let Address::File(name) = container::address(uri) {
            bundle.fetch(files, &name);
        }
    }
}

/// The model of a glTF file; none if anything is wrong, which is reported.
pub(super) fn read(bundle: &Bundle, report: &mut Report) -> Option<Model> {
    let container = match container::open(&bundle.bytes) {
        Ok(container) => container,
        Err((place, message)) => {
            report.error(place, message);
            return None;
        }
    };
    check_head(container.json, report)?;
    let document: Document = parse(container.json, report)?;
    note_extensions(&document, report);
    let data = Data::open(&document, container.binary, bundle, report);
    let mut model = Model::default();
    let mut materials = material::Materials::read(&data, bundle, report);
    model.meshes = meshes(&data, &mut materials, report);
    (model.materials, model.images) = materials.finish();
    model.cameras = nodes::cameras(&document, report);
    model.lights = nodes::lights(&document);
    let placed = nodes::read(&document, &mut model, report)?;
    take_draws(&model, report)?;
    note_unused(&document, &model, report);
    model.animations = animation::read(&data, &placed, &model.nodes, report);
    Some(model)
}

/// What whoever draws a model keeps for each primitive of each node: a call, a place and a matrix.
const DRAW_BYTES: usize = 256;

/// Takes room for all that is drawn: many nodes may share a mesh of many primitives.
fn take_draws(model: &Model, report: &mut Report) -> Option<()> {
    let shown = model.nodes.iter().filter_map(|node| model.meshes.get(node.mesh?));
    let draws = shown.fold(0_usize, |sum, mesh| sum.saturating_add(mesh.primitives.len()));
    report.take_for(draws.saturating_mul(DRAW_BYTES), "copies of its meshes", "nodes").then_some(())
}

fn meshes(data: &Data<'_>, materials: &mut material::Materials, report: &mut Report) -> Vec<Mesh> {
    let meshes = data.document.meshes.iter().enumerate();
    meshes
        .map(|(index, mesh)| {
            let primitives = mesh.primitives.iter().enumerate();
            let primitives = primitives
                .filter_map(|(number, primitive)| {
                    let place = format!("mesh {index}, primitive {number}");
                    primitive::read(data, primitive, materials, &place, report)
                })
                .collect();
            Mesh { name: mesh.name.clone(), primitives }
        })
        .collect()
}

fn parse<T: serde::de::DeserializeOwned>(json: &[u8], report: &mut Report) -> Option<T> {
    match serde_json::from_slice(json) {
        Ok(document) => Some(document),
        Err(error) => {
            let place = format!("line {}, column {}", error.line(), error.column());
            let text = error.to_string();
            let message = text.rsplit_once(" at line ").map_or(text.as_str(), |(message, _)| message);
            report.error(place, format!("the JSON does not fit glTF 2.0: {message}"));
            None
        }
    }
}

/// Whether this is a document that can be understood.
fn check_head(json: &[u8], report: &mut Report) -> Option<()> {
    let head: Head = parse(json, report)?;
    let Some(asset) = head.asset else {
        report.error("", "this is no glTF: it has no `asset`");
        return None;
    };
    let version = asset.min_version.or(asset.version).unwrap_or_default();
    if version.split('.').next() != Some("2") {
        report.error("asset", format!("this is glTF {}; version 2.0 is read", shown(&version)));
        return None;
    }
    let unknown = head.extensions_required.iter().filter(|name| !SUPPORTED.contains(&name.as_str()));
    let unknown: Vec<String> = unknown.map(|name| shown(name)).collect();
    if unknown.is_empty() {
        return Some(());
    }
    let message = format!("the file requires {}, which cannot be read", unknown.join(", "));
    report.error_with_hint("extensionsRequired", message, "export the model again without it");
    None
}

/// Says what is understood and yet not seen in a picture: worth a warning if the file insists on it.
fn note_unused(document: &Document, model: &Model, report: &mut Report) {
    let mut say = |extension: &str, message: String| match document.extensions_required.iter().any(|e| e == extension) {
        true => report.warn("", message),
        false => report.note("", message),
    };
    let lights = model.nodes.iter().filter(|node| node.light.is_some()).count();
    if lights > 0 {
        let are = if lights == 1 { "is" } else { "are" };
        let lights = counted(lights, "light of the file", "lights of the file");
        say("KHR_lights_punctual", format!("{lights} {are} not used: those of a scene are, under `lights:`"));
    }
    let clear = model.materials.iter().filter(|material| material.transmission_factor > 0.0).count();
    if clear > 0 {
        let lets = if clear == 1 { "lets" } else { "let" };
        let materials = counted(clear, "material", "materials");
        let message = format!("{materials} {lets} light through, which is not drawn: they look as without it");
        say("KHR_materials_transmission", if clear == 1 { message.replace("they look", "it looks") } else { message });
    }
}

/// Says which extensions are read over.
fn note_extensions(document: &Document, report: &mut Report) {
    let unknown = document.extensions_used.iter().filter(|name| !SUPPORTED.contains(&name.as_str()));
    let unknown: Vec<String> = unknown.map(|name| shown(name)).collect();
    if !unknown.is_empty() {
        report.note("extensionsUsed", format!("read over: {}", unknown.join(", ")));
    }
}
