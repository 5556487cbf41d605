//! The files that a scene names, found and begun to be read.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Loader;
use crate::diagnostic::{Diagnostic, Span};
use crate::files::{self, Kind};
use crate::host::assets::{AssetKind, Pending};
use crate::host::frames::{self, Located};
use crate::host::inputs::{Frames, ImageFiles, ParticleFile};
use crate::host::models::{MeshFiles, Reading};
use crate::host::source;
use crate::program::missing_file;
use crate::scene::particles::Taken;
use crate::scene::sequence::Sequence;
use crate::scene::{self, Item, Scene};
use crate::syntax::Sp;

impl Loader<'_> {
    /// The scene's particle files, with those that the command line puts in their place.
    pub(super) fn particles(&mut self, scene: &Scene, given: bool) -> Vec<ParticleFile> {
        let (replaced, file) = match self.job.particles.as_deref().map(|text| (text, text.split_once('='))) {
            Some((_, Some((name, file)))) => (Some(name.to_owned()), Some(file.to_owned())),
            Some((file, None)) => (None, Some(file.to_owned())),
            None => (None, None),
        };
        let mut list = Vec::new();
        for item in &scene.particles {
            // The one file on the command line takes the place of the scene's one.
            let same = replaced.as_deref().is_none_or(|name| name == item.name.value);
            let is_replaced = file.is_some() && same && (replaced.is_some() || scene.particles.len() == 1);
            if is_replaced {
                continue;
            }
            let name = &item.value.file;
            let (path, bytes, sequence) = match &item.value.sequence {
                None => {
                    let (path, bytes) = self.asset(&name.value, &scene.path, name.span);
                    (path, bytes, None)
                }
                Some(sequence) => self.frame(&name.value, sequence, Some(&scene.path), Some(name.span)),
            };
            let said = self.job.radius_m.or(item.value.radius_m.as_ref().map(|r| r.value));
            let asked = (said, item.value.taken.clone());
            let file = self.particle_file(Some(item.name.value.clone()), path, bytes, asked, Some(name.span));
            list.push(ParticleFile { bounds: item.value.bounds, sequence, ..file });
        }
        let source = given.then(|| (None, self.job.source.clone()));
        for (name, path) in source.into_iter().chain(file.map(|file| (replaced, PathBuf::from(file)))) {
            let (path, bytes, sequence) = match source::sequence(self.files, &path) {
                Some(pattern) => self.frame(&pattern, &Sequence::default(), None, None),
                None => {
                    self.read.push(path.clone());
                    let bytes = source::named(self.files, &path).map_err(|error| self.diagnostics.push(error)).ok();
                    (path, bytes, None)
                }
            };
            let taken = Taken { placement: self.job.placement(), ..Taken::default() };
            let file = self.particle_file(name, path, bytes, (self.job.radius_m, taken), None);
            list.push(ParticleFile { sequence, ..file });
        }
        list
    }

    /// The file of a sequence that shows at the moment asked for.
    fn frame(
        &mut self,
        name: &str,
        sequence: &Sequence,
        beside: Option<&Path>,
        at: Option<Span>,
    ) -> (PathBuf, Option<Arc<[u8]>>, Option<Frames>) {
        let label = |found: Diagnostic| match at {
            Some(span) => found.at(span, "named here"),
            None => found,
        };
        match frames::locate(self.files, name, sequence, beside, self.job.when) {
            Ok(Located { path, frames, held }) => {
                held.into_iter().for_each(|held| self.diagnostics.push(label(held)));
                self.read.push(path.clone());
                let bytes = source::named(self.files, &path).map_err(|error| self.diagnostics.push(label(error))).ok();
                (path, bytes, Some(frames))
            }
            Err(error) => {
                self.diagnostics.push(label(error));
                (PathBuf::from(name), None, None)
            }
        }
    }

    fn particle_file(
        &self,
        name: Option<String>,
        path: PathBuf,
        bytes: Option<Arc<[u8]>>,
        (radius_m, taken): (Option<f64>, Taken),
        at: Option<Span>,
    ) -> ParticleFile {
        let kind = AssetKind::Particles { taken: taken.clone(), estimate: radius_m.is_none() };
        let pending = bytes.map(|bytes| self.cache.begin(&path, bytes, kind, at));
        ParticleFile { name, path, pending, radius_m, taken, bounds: None, sequence: None }
    }

    /// The pictures of each name: one, or the six faces of a cube.
    pub(super) fn images(&mut self, scene: &Scene) -> Vec<ImageFiles> {
        let mut list = Vec::new();
        for Item { name, value: file, .. } in &scene.textures {
            let pending = vec![self.image(file, &scene.path)];
            list.push(ImageFiles { name: name.value.clone(), pending, cube_at: None });
        }
        if let Some(Item { name, value, span }) = &scene.cube {
            let pending = value.files().iter().map(|file| self.image(file, &scene.path)).collect();
            list.push(ImageFiles { name: name.value.clone(), pending, cube_at: Some(*span) });
        }
        list
    }

    /// The scene's bodies, with their files being read.
    pub(super) fn meshes(&mut self, scene: &Scene) -> (Vec<MeshFiles>, Reading) {
        let (mut all, mut reading) = (Vec::new(), Reading::default());
        for item in &scene.meshes {
            let mut paths = Vec::with_capacity(item.value.len());
            for entry in &item.value {
                let (path, bytes) = self.asset(&entry.file.value, &scene.path, entry.file.span);
                let is_there = bytes.is_some();
                if let Some(bytes) = bytes.filter(|_| !reading.has(&path)) {
                    let bundle = scene::meshes::gather(self.files, &path, bytes);
                    self.read.extend(bundle.looked_at.iter().cloned());
                    reading.begin(&self.cache.models, bundle, entry.file.span);
                }
                paths.push(is_there.then_some(path));
            }
            all.push(MeshFiles { name: item.name.value.clone(), entries: item.value.clone(), paths });
        }
        (all, reading)
    }

    fn image(&mut self, file: &Sp<String>, scene: &Path) -> Option<Pending> {
        let (path, bytes) = self.asset(&file.value, scene, file.span);
        Some(self.cache.begin(&path, bytes?, AssetKind::Image, Some(file.span)))
    }

    /// A file that a scene names: its path, and its bytes if it is there.
    fn asset(&mut self, name: &str, scene: &Path, at: Span) -> (PathBuf, Option<Arc<[u8]>>) {
        match files::find(self.files, Kind::Asset, name, Some(scene)) {
            Ok(found) => {
                self.read.push(found.path.clone());
                (found.path, Some(found.bytes))
            }
            Err(missing) => {
                self.read.extend(missing.tried.iter().cloned());
                self.diagnostics.push(missing_file(name, Kind::Asset, &missing, Some(at)));
                (PathBuf::from(name), None)
            }
        }
    }
}
