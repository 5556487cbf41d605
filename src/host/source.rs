//! What is rendered: a scene file, or particles that get the default scene.

use std::path::Path;
use std::sync::Arc;

use glam::DMat4;

use super::load::Job;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};
use crate::files::{Files, LIBRARY, library_file};
use crate::scene::placement::Placement;
use crate::scene::sequence::Pattern;
use crate::scene::{self, Item, MeshEntry, Scene, meshes, particles};
use crate::syntax::Sp;

/// The scene for particles that came without one, in the library that the program carries.
const DEFAULT_SCENE: &str = "scenes/default.ron";

/// The input that a mesh file by itself feeds: so the shipped graphs call theirs.
const MESHES: &str = "meshes";

/// A scene, perhaps the default one for a particle file that was given in its place.
#[derive(Debug)]
pub(super) struct Source {
    pub scene: Scene,
    pub brings: Brings,
}

/// What kind of file was named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Brings {
    Scene,
    Particles,
    Mesh,
}

/// Whether a path names a scene file by its extension.
fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case("ron"))
}

/// Reads the file that was named.
pub(super) fn read(
    files: &dyn Files,
    job: &Job,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> Option<Source> {
    let path = &job.source;
    if let Err(error) = renderable(files, path) {
        diagnostics.push(error);
        return None;
    }
    if is_scene(path) {
        let bytes = named(files, path).map_err(|error| diagnostics.push(error)).ok()?;
        let scene = scene::read(path, &bytes, sources, diagnostics)?;
        Some(Source { scene, brings: Brings::Scene })
    } else if is_mesh(files, path) {
        let mut scene = default_scene(sources, diagnostics)?;
        stand(&mut scene, job);
        Some(Source { scene, brings: Brings::Mesh })
    } else {
        let scene = default_scene(sources, diagnostics)?;
        Some(Source { scene, brings: Brings::Particles })
    }
}

/// Whether a path names a mesh file. What may also be particles is a mesh if it has faces.
fn is_mesh(files: &dyn Files, path: &Path) -> bool {
    meshes::known_extension(path)
        && (!particles::known_extension(path) || files.read(path).is_ok_and(|bytes| meshes::has_faces(&bytes)))
}

/// Puts a mesh file into a scene that has no other.
fn stand(scene: &mut Scene, job: &Job) {
    let said = |value: String| Sp { value, span: scene.span };
    let file = std::path::absolute(&job.source).unwrap_or_else(|_| job.source.clone());
    let Placement { scale, turn, .. } = job.placement();
    let world_from_body = vec![DMat4::from_mat3(turn * scale)];
    let value = vec![MeshEntry { world_from_body, ..MeshEntry::of(said(file.display().to_string())) }];
    scene.meshes = vec![Item { name: said(MESHES.into()), value, span: scene.span }];
}

/// The pattern that a path of the command line is: a file that bears the `#` itself is one file.
pub(super) fn sequence(files: &dyn Files, path: &Path) -> Option<String> {
    Pattern::of(path).filter(|_| !files.exists(path))?;
    path.to_str().map(str::to_owned)
}

/// Whether a file can be rendered, as far as its name tells.
///
/// # Errors
/// If it is missing or a folder, or neither a scene nor a particle file.
pub fn renderable(files: &dyn Files, path: &Path) -> Result<(), Diagnostic> {
    if !files.exists(path) && sequence(files, path).is_none() {
        // Says why: missing, a folder, unreadable.
        named(files, path)?;
    }
    if is_scene(path) || particles::known_extension(path) || meshes::known_extension(path) {
        return Ok(());
    }
    let message = format!("`{}` is neither a scene (.ron) nor a particle or mesh file", path.display());
    let ends: Vec<String> = particles::extensions().collect();
    let hint = format!("particle files end in {}; mesh files in .gltf, .glb, .obj", ends.join(", "));
    Err(Diagnostic::error(Code::USAGE, message).hint(hint))
}

/// The scene that the program carries.
pub(super) fn default_scene(sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<Scene> {
    let path = Path::new(LIBRARY).join(DEFAULT_SCENE);
    match library_file(Path::new(DEFAULT_SCENE)) {
        Some(bytes) => scene::read(&path, bytes, sources, diagnostics),
        None => {
            diagnostics.push(Diagnostic::error(Code::FILE_MISSING, "this build carries no default scene"));
            None
        }
    }
}

/// The bytes of a file that the command line names.
///
/// # Errors
/// If it is missing, a folder, or unreadable.
pub(crate) fn named(files: &dyn Files, path: &Path) -> Result<Arc<[u8]>, Diagnostic> {
    if path.is_dir() {
        return Err(Diagnostic::error(Code::FILE_UNREADABLE, format!("`{}` is a folder", path.display()))
            .hint("name a file in it"));
    }
    files.read(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => {
            Diagnostic::error(Code::FILE_MISSING, format!("there is no file `{}`", path.display()))
        }
        _ => Diagnostic::error(Code::FILE_UNREADABLE, format!("`{}` cannot be read: {error}", path.display())),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::MemoryFiles;

    #[test]
    fn what_has_faces_opens_as_a_mesh() {
        let points = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n";
        let surface =
            points.replace("end_header", "element face 2\nproperty list uchar int vertex_indices\nend_header");
        let files =
            MemoryFiles::default().with("a.ply", points).with("b.ply", surface).with("c.obj", "").with("d.xyz", "");
        let brings = |name: &str| {
            let job = Job { source: name.into(), ..Job::default() };
            read(&files, &job, &mut Sources::new(), &mut Diagnostics::new()).map(|source| source.brings)
        };
        assert_eq!(
            ["a.ply", "b.ply", "c.obj", "d.xyz"].map(brings),
            [Some(Brings::Particles), Some(Brings::Mesh), Some(Brings::Mesh), Some(Brings::Particles)]
        );
    }
}
