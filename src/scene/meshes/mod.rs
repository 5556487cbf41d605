//! Mesh files as plain data: triangles with every attribute filled, materials by glTF 2.0's names,
//! a tree of nodes and its animations.
//!
//! [`gather`] collects a file and what it names through the one door to files; [`read()`] makes a
//! [`Model`] of it, on any thread. Nothing here knows a device. Normals and tangents are made
//! where a file has none, and what a file leaves out has glTF's default, so that whoever draws a
//! model asks no questions. A reader never trusts a file: memory is bounded by what its bytes can
//! justify, and what is wrong is a diagnostic that names the file and the place.

mod bundle;
mod faces;
mod fill;
mod gltf;
mod model;
mod obj;
mod pictures;
mod polygon;
mod pose;
mod report;
mod surface;
mod tangents;

use std::path::Path;
use std::sync::Arc;

use crate::diagnostic::Diagnostics;
use crate::files::Files;

pub use bundle::Bundle;
pub use faces::has_faces;
pub use model::{
    AlphaMode, Animation, Bounds, Channel, Filter, Interpolation, Keys, Lamp, LampKind, Lens, LensKind, Local,
    Material, Mesh, Model, Node, Primitive, Sampler, TextureUse, UvTransform, Wrap,
};
pub use pose::{Pose, is_mirrored};
use report::{Report, shown};

type Gatherer = fn(&mut Bundle, &dyn Files);
type Reader = fn(&Bundle, &mut Report) -> Option<Model>;

/// Ends of file names, who finds the files that such a file names, and who reads them.
const READERS: &[(&str, Gatherer, Reader)] = &[
    ("gltf", gltf::gather, gltf::read),
    ("glb", gltf::gather, gltf::read),
    ("obj", obj::gather, obj::read),
    ("ply", surface::gather, surface::read),
    ("vtk", surface::gather, surface::read),
];

fn reader_for(path: &Path) -> Option<(Gatherer, Reader)> {
    let end = path.extension()?.to_str()?;
    READERS.iter().find(|(known, ..)| end.eq_ignore_ascii_case(known)).map(|(_, gather, read)| (*gather, *read))
}

/// Whether [`read()`] knows files of this name.
pub fn known_extension(path: &Path) -> bool {
    reader_for(path).is_some()
}

/// Collects the files that a mesh file names. What is missing is told by [`read()`], which knows
/// whether it matters.
pub fn gather(files: &dyn Files, path: &Path, bytes: Arc<[u8]>) -> Bundle {
    let mut bundle = Bundle::alone(path, bytes);
    if let Some((gather, _)) = reader_for(path) {
        gather(&mut bundle, files);
    }
    bundle
}

/// Reads a mesh file.
///
/// # Errors
/// If the extension is unknown, or the bytes are not what they claim to be: all findings.
pub fn read(bundle: &Bundle) -> Result<Model, Diagnostics> {
    let mut report = Report::new(&bundle.path, bundle.size());
    let Some((_, reader)) = reader_for(&bundle.path) else {
        let known: Vec<String> = READERS.iter().map(|(end, ..)| format!(".{end}")).collect();
        let hint = format!("known are {}", known.join(", "));
        report.error_with_hint("", "its extension is not that of a mesh file", &hint);
        return Err(report.finish());
    };
    if bundle.bytes.is_empty() {
        report.error("", "the file is empty");
        return Err(report.finish());
    }
    let model = reader(bundle, &mut report);
    if let Some(model) = model.as_ref().filter(|_| !report.has_errors()) {
        check_extent(model, &mut report);
    }
    match model.filter(|_| !report.has_errors()) {
        Some(mut model) => {
            // A file of cameras has no need of any.
            if model.triangle_count() == 0 && model.nodes.iter().all(|node| node.camera.is_none()) {
                report.warn("", "the file draws no triangles");
            }
            model.diagnostics = report.finish();
            Ok(model)
        }
        None => Err(report.finish()),
    }
}

/// Metres along an axis, up to which single precision still squares and multiplies what it is given.
pub const FARTHEST_M: f32 = 1e18;

/// Reports what lies so far away that nothing can be reckoned with it.
fn check_extent(model: &Model, report: &mut Report) {
    let Some(index) = model.beyond(FARTHEST_M, &model.pose(None, 0.0)) else { return };
    let name = &model.nodes[index].name;
    let place = if name.is_empty() { String::new() } else { format!("node {}", shown(name)) };
    report.error(place, format!("its vertices reach beyond {FARTHEST_M:e} m, with which nothing can be reckoned"));
}
