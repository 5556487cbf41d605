//! Mesh files as plain data: triangles with every attribute filled, materials by glTF 2.0's names,
//! a tree of nodes and its animations.
//!
//! [`gather`] collects a file and what it names through the one door to files; [`read()`] makes a
//! [`Model`] of it, on any thread. Nothing here knows a device. Normals and tangents are made
//! where a file has none, and what a file leaves out has glTF's default, so that whoever draws a
//! model asks no questions. A reader never trusts a file: memory is bounded by what its bytes can
//! justify, and what is wrong is a diagnostic that names the file and the place.

#[allow(dead_code, reason = "its readers come next")]
mod bundle;
mod model;
mod pose;

use std::path::Path;
use std::sync::Arc;

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::files::Files;

pub use bundle::Bundle;
pub use model::{
    AlphaMode, Animation, Bounds, Channel, Filter, Interpolation, Keys, Lamp, LampKind, Lens, LensKind, Local,
    Material, Mesh, Model, Node, Primitive, Sampler, TextureUse, UvTransform, Wrap,
};
pub use pose::is_mirrored;

/// Whether [`read()`] knows files of this name.
pub fn known_extension(path: &Path) -> bool {
    let known = ["gltf", "glb", "obj", "ply", "vtk"];
    path.extension().is_some_and(|end| known.iter().any(|k| end.eq_ignore_ascii_case(k)))
}

/// Collects the files that a mesh file names. What is missing is told by [`read()`], which knows
/// whether it matters.
pub fn gather(files: &dyn Files, path: &Path, bytes: Arc<[u8]>) -> Bundle {
    let _ = files;
    Bundle::alone(path, bytes)
}

/// Reads a mesh file.
///
/// # Errors
/// If the extension is unknown, or the bytes are not what they claim to be: all findings.
pub fn read(bundle: &Bundle) -> Result<Model, Diagnostics> {
    Err(Diagnostic::error(Code::ASSET, format!("`{}`: no reader yet", bundle.path.display())).into())
}
