//! The files that a scene names, found and begun to be read.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Loader;
use crate::diagnostic::{Diagnostic, Span};
use crate::files::{self, Kind};
use crate::host::assets::{AssetKind, Pending};
use crate::host::frames::{self, Located};
use crate::host::inputs::{ImageFiles, ParticleFile};
use crate::host::models::{MeshFiles, Reading};
use crate::host::sequence::{Frames, Timeline};
use crate::host::source;
use crate::program::missing_file;
use crate::scene::particles::Taken;
use crate::scene::sequence::Sequence;
use crate::scene::{self, Item, ParticleSource, Scene};
use crate::syntax::Sp;

/// Particles that somebody asks for.
enum Asked<'a> {
    Scene(&'a Item<ParticleSource>),
    /// By the command line, perhaps without the name of an input.
    Said(Option<String>, PathBuf),
}

/// A file that was looked for: its path, its bytes if it is there, and the sequence that it is of.
struct Gathered {
    path: PathBuf,
    bytes: Option<Arc<[u8]>>,
    sequence: Option<Frames>,
    is_early: bool,
}

impl Gathered {
    fn one(path: PathBuf, bytes: Option<Arc<[u8]>>) -> Self {
        Self { path, bytes, sequence: None, is_early: false }
    }
}

impl Loader<'_> {
    /// The scene's particle files, with those that the command line puts in their place.
    pub(super) fn particles(&mut self, scene: &Scene, given: bool) -> Vec<ParticleFile> {
        let mut list = Vec::new();
        // That of the first sequence.
        let mut timeline = None;
        for asked in self.asked(scene, given) {
            let file = match asked {
                Asked::Scene(item) => self.of_scene(item, &scene.path, timeline.as_ref()),
                Asked::Said(name, path) => self.said(name, path, timeline.as_ref()),
            };
            timeline = timeline.or_else(|| Some(file.sequence.as_ref()?.timeline.clone()));
            list.push(file);
        }
        list
    }

    /// What the command line puts in the place of an item of the scene stands where that did.
    fn asked<'s>(&self, scene: &'s Scene, given: bool) -> Vec<Asked<'s>> {
        let (replaced, mut file) = match self.job.particles.as_deref().map(|text| (text, text.split_once('='))) {
            Some((_, Some((name, file)))) => (Some(name.to_owned()), Some(PathBuf::from(file))),
            Some((file, None)) => (None, Some(PathBuf::from(file))),
            None => (None, None),
        };
        let mut all = Vec::new();
        for item in &scene.particles {
            // The one file on the command line takes the place of the scene's one.
            let is_replaced = match &replaced {
                Some(name) => *name == item.name.value,
                None => scene.particles.len() == 1,
            };
            all.push(match file.take_if(|_| is_replaced) {
                Some(file) => Asked::Said(replaced.clone(), file),
                None => Asked::Scene(item),
            });
        }
        all.extend(given.then(|| Asked::Said(None, self.job.source.clone())));
        all.extend(file.map(|file| Asked::Said(replaced, file)));
        all
    }

    fn of_scene(&mut self, item: &Item<ParticleSource>, scene: &Path, timeline: Option<&Timeline>) -> ParticleFile {
        let name = &item.value.file;
        let found = match &item.value.sequence {
            None => {
                let (path, bytes) = self.asset(&name.value, scene, name.span);
                Gathered::one(path, bytes)
            }
            Some(sequence) => self.frame(&name.value, sequence, (Some(scene), Some(name.span)), timeline),
        };
        let radius_m = self.job.radius_m.or(item.value.radius_m.as_ref().map(|r| r.value));
        let asked = (radius_m, item.value.taken.clone());
        let file = self.particle_file(Some(item.name.value.clone()), found, asked, Some(name.span));
        ParticleFile { bounds: item.value.bounds, ..file }
    }

    fn said(&mut self, name: Option<String>, path: PathBuf, timeline: Option<&Timeline>) -> ParticleFile {
        let found = match source::sequence(self.files, &path) {
            Some(pattern) => self.frame(&pattern, &Sequence::default(), (None, None), timeline),
            None => {
                self.read.push(path.clone());
                let bytes = source::named(self.files, &path).map_err(|error| self.diagnostics.push(error)).ok();
                Gathered::one(path, bytes)
            }
        };
        let taken = Taken { placement: self.job.placement(), ..Taken::default() };
        self.particle_file(name, found, (self.job.radius_m, taken), None)
    }

    /// The file of a sequence that shows at the moment asked for.
    fn frame(
        &mut self,
        name: &str,
        sequence: &Sequence,
        (beside, at): (Option<&Path>, Option<Span>),
        timeline: Option<&Timeline>,
    ) -> Gathered {
        let label = |found: Diagnostic| match at {
            Some(span) => found.at(span, "named here"),
            None => found,
        };
        match frames::locate(self.files, name, sequence, (beside, self.job.when), timeline) {
            Ok(Located { path, frames, told }) => {
                told.into_iter().for_each(|told| self.diagnostics.push(label(told)));
                self.read.push(path.clone());
                let bytes = source::named(self.files, &path).map_err(|error| self.diagnostics.push(label(error))).ok();
                let is_early = frames.frame(self.job.when).is_none();
                Gathered { path, bytes, sequence: Some(frames), is_early }
            }
            Err(error) => {
                self.diagnostics.push(label(error));
                Gathered::one(PathBuf::from(name), None)
            }
        }
    }

    fn particle_file(
        &self,
        name: Option<String>,
        found: Gathered,
        (radius_m, taken): (Option<f64>, Taken),
        at: Option<Span>,
    ) -> ParticleFile {
        let Gathered { path, bytes, sequence, is_early } = found;
        let kind = AssetKind::Particles { taken: taken.clone(), estimate: radius_m.is_none() };
        let pending = bytes.map(|bytes| self.cache.begin(&path, bytes, kind, at));
        ParticleFile { name, path, pending, radius_m, taken, bounds: None, sequence, is_early }
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
                if let Some(bytes) = bytes {
                    self.begin_mesh(&path, bytes, entry.file.span, &mut reading);
                }
                paths.push(is_there.then_some(path));
            }
            all.push(MeshFiles { name: item.name.value.clone(), entries: item.value.clone(), paths });
        }
        (all, reading)
    }

    /// The file of the scene's camera, being read.
    pub(super) fn camera_file(&mut self, scene: &Scene, reading: &mut Reading) -> Option<PathBuf> {
        let file = &scene.camera_file.as_ref()?.value.entry.file;
        let (path, bytes) = self.asset(&file.value, &scene.path, file.span);
        self.begin_mesh(&path, bytes?, file.span, reading);
        Some(path)
    }

    /// Begins to read a mesh file, once.
    fn begin_mesh(&mut self, path: &Path, bytes: Arc<[u8]>, at: Span, reading: &mut Reading) {
        if !reading.has(path) {
            let bundle = scene::meshes::gather(self.files, path, bytes);
            self.read.extend(bundle.looked_at.iter().cloned());
            reading.begin(&self.cache.models, bundle, at);
        }
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
