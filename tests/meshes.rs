//! Mesh files: the same triangles, materials and poses as other readers find in the same files,
//! every form that the formats have, and wrong and hostile files.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

#[path = "meshes/build.rs"]
mod build;
#[path = "meshes/forms.rs"]
mod forms;
#[path = "support/fuzz.rs"]
mod fuzz;
#[path = "support/golden.rs"]
mod golden;
#[path = "meshes/hostile.rs"]
mod hostile;
#[path = "meshes/obj.rs"]
mod obj;
#[path = "meshes/own.rs"]
mod own;
#[path = "meshes/shared.rs"]
mod shared;
#[path = "meshes/surface.rs"]
mod surface;
#[path = "meshes/wrong.rs"]
mod wrong;

use std::path::Path;

use meniscus::diagnostic::{Diagnostics, Severity};
use meniscus::files::MemoryFiles;
use meniscus::scene::meshes::{self, Model};

/// Reads a file from a folder in memory.
fn read(files: &MemoryFiles, path: &str) -> Result<Model, Diagnostics> {
    let bytes = files.0.get(Path::new(path)).cloned().unwrap_or_default();
    meshes::read(&meshes::gather(files, Path::new(path), bytes))
}

/// Findings a line each, as a person sees them, without the file's name.
fn said(diagnostics: &Diagnostics, path: &str) -> String {
    let lines = diagnostics.iter().map(|found| {
        let kind = match found.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        let message = found.message.strip_prefix(&format!("`{path}`: ")).unwrap_or(&found.message);
        let hints: Vec<String> = found.hints.iter().map(|hint| format!(" [{hint}]")).collect();
        format!("{kind}: {message}{}\n", hints.concat())
    });
    lines.collect()
}

/// A model that must be read without a word.
#[track_caller]
fn whole(files: &MemoryFiles, path: &str) -> Model {
    let model = read(files, path).unwrap_or_else(|found| panic!("{}", said(&found, path)));
    assert_eq!(said(&model.diagnostics, path), "");
    model
}
