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
use super::report::{Report, shown};
use crate::files::Files;
use statements::Statements;

/// Fetches material files and the pictures that they name.
pub(super) fn gather(bundle: &mut Bundle, files: &dyn Files) {
    let bytes = bundle.bytes.clone();
    for (_, line) in statements::material_files(&bytes) {
        // Names may hold spaces, or several stand on one line.
        bundle.fetch_or_beside(files, Path::new(""), &line);
        if bundle.other_or_beside(Path::new(""), &line).is_err() && line.contains(char::is_whitespace) {
            line.split_whitespace().for_each(|part| bundle.fetch(files, part));
            several(&line).iter().for_each(|part| bundle.fetch_or_beside(files, Path::new(""), part));
        }
    }
    for (_, name) in libraries(bundle, &bytes) {
        let Ok((name, text)) = bundle.other_or_beside(Path::new(""), &name) else { continue };
        let (pictures, folder) = (mtl::pictures(text), folder(&name).to_owned());
        pictures.iter().for_each(|picture| bundle.fetch_or_beside(files, &folder, &mtl::from(&folder, picture)));
    }
}

pub(super) fn read(bundle: &Bundle, report: &mut Report) -> Option<Model> {
    let statements = Statements::read(&bundle.bytes, report)?;
    let mut materials = mtl::Materials::default();
    for (line, name) in libraries(bundle, &bundle.bytes) {
        let place = format!("line {line}, mtllib");
        match bundle.other_or_beside(Path::new(""), &name) {
            Ok((found, text)) => {
                if found != name {
                    report.note(&place, format!("{} is a path of elsewhere: {} is read", shown(&name), shown(&found)));
                }
                materials.read(&found, text, bundle, report);
            }
            Err(why) => report.warn(&place, format!("{} {why}: its materials are not known", shown(&name))),
        }
    }
    assemble::model(&statements, materials, report)
}

/// The material files of a file, each once, with the first line that names it: as one name if there
/// is such a file, else as several.
fn libraries(bundle: &Bundle, bytes: &[u8]) -> Vec<(usize, String)> {
    let mut names: Vec<(usize, String)> = Vec::new();
    for (number, line) in statements::material_files(bytes) {
        let is_whole = bundle.other_or_beside(Path::new(""), &line).is_ok();
        let parts = || line.split_whitespace();
        let found: Vec<String> = match parts().any(|part| bundle.other(part).is_ok()) {
            _ if is_whole => vec![line],
            true if several(&line).iter().all(|name| bundle.other(name).is_err()) => {
                parts().map(str::to_owned).collect()
            }
            _ => several(&line),
        };
        for name in found {
            if !names.iter().any(|(_, known)| *known == name) {
                names.push((number, name));
            }
        }
    }
    names
}

/// A line of names that may hold spaces: each goes on until a word ends as such files do.
fn several(line: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut rest = line.trim();
    while !rest.is_empty() {
        let words = rest.match_indices(char::is_whitespace).map(|(at, _)| at).chain([rest.len()]);
        let is_end = |at: &usize| {
            let end = at.checked_sub(4).and_then(|start| rest.get(start..*at));
            end.is_some_and(|end| end.eq_ignore_ascii_case(".mtl"))
        };
        let (name, after) = rest.split_at(words.into_iter().find(is_end).unwrap_or(rest.len()));
        names.push(name.to_owned());
        rest = after.trim_start();
    }
    names
}

/// The folder of a material file, from the model's own on.
fn folder(name: &str) -> &Path {
    Path::new(name).parent().unwrap_or(Path::new(""))
}
