//! Wavefront OBJ with its materials: polygons of any number of corners, relative indices, vertex
//! colours, smoothing groups. Lines, points, curves and surfaces are read over and said.
//!
//! Faces without normals are smooth where they share a vertex and a smoothing group. A file that
//! never speaks of smoothing groups is one group.

mod assemble;
mod mtl;
mod statements;

use std::path::Path;

use super::bundle::Bundle;
use super::model::Model;
use super::report::Report;
use crate::files::Files;
use statements::Statements;

/// Fetches material files and the pictures that they name.
pub(super) fn gather(bundle: &mut Bundle, files: &dyn Files) {
    let bytes = bundle.bytes.clone();
    for name in statements::material_files(&bytes) {
        // Names may hold spaces, or several stand on one line.
        bundle.fetch(files, &name);
        if bundle.other(&name).is_err() && name.contains(' ') {
            name.split_whitespace().for_each(|part| bundle.fetch(files, part));
        }
    }
    let libraries = libraries(bundle, &bytes);
    for name in libraries {
        let Ok(text) = bundle.other(&name).map(<[u8]>::to_vec) else { continue };
        mtl::pictures(&text, folder(&name)).iter().for_each(|picture| bundle.fetch(files, picture));
    }
}

pub(super) fn read(bundle: &Bundle, report: &mut Report) -> Option<Model> {
    let statements = Statements::read(&bundle.bytes, report)?;
    let mut materials = mtl::Materials::default();
    for name in libraries(bundle, &bundle.bytes) {
        match bundle.other(&name) {
            Ok(text) => materials.read(&name, text, bundle, report),
            Err(why) => report.warn("mtllib", format!("`{name}` {why}: its materials are not known")),
        }
    }
    assemble::model(&statements, materials, report)
}

/// The material files of a file, each once: as one name if there is such a file, else as several.
fn libraries(bundle: &Bundle, bytes: &[u8]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for line in statements::material_files(bytes) {
        let parts = line.split_whitespace();
        let is_several = bundle.other(&line).is_err() && parts.clone().any(|part| bundle.other(part).is_ok());
        let found = if is_several { parts.map(str::to_owned).collect() } else { vec![line] };
        found
            .into_iter()
            .filter(|name| !names.contains(name))
            .collect::<Vec<_>>()
            .into_iter()
            .for_each(|n| names.push(n));
    }
    names
}

/// The folder of a material file, from the model's own on.
fn folder(name: &str) -> &Path {
    Path::new(name).parent().unwrap_or(Path::new(""))
}
