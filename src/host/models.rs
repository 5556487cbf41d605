//! Mesh files that a scene names, read on threads of their own, once for as long as their bytes
//! stay, and put together as what feeds an input.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use super::meshes::{Meshes, choice};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span};
use crate::scene::meshes::{Bundle, Model, read};
use crate::scene::{Item, MeshEntry};

/// What was read and put together before.
#[derive(Debug, Default)]
pub(super) struct Models {
    read: BTreeMap<PathBuf, (u128, Arc<Model>)>,
    joined: BTreeMap<String, Joined>,
}

/// What feeds an input, with what it was made from.
#[derive(Debug)]
struct Joined {
    entries: Vec<MeshEntry>,
    models: Vec<Arc<Model>>,
    meshes: Arc<Meshes>,
}

/// Bodies of a scene under one name, their files perhaps still being read.
#[derive(Debug)]
pub(super) struct MeshFiles {
    pub name: String,
    pub entries: Vec<MeshEntry>,
    /// The path of each entry's file; absent if there is no such file, which was reported.
    pub paths: Vec<Option<PathBuf>>,
}

/// Mesh files that are being read, by path.
#[derive(Debug, Default)]
pub(super) struct Reading(BTreeMap<PathBuf, (u128, Span, Work)>);

#[derive(Debug)]
enum Work {
    Done(Arc<Model>),
    Running(JoinHandle<Result<Model, Diagnostics>>),
}

impl Reading {
    pub fn has(&self, path: &Path) -> bool {
        self.0.contains_key(path)
    }

    /// Begins to read a file, or finds it read. Messages point at `at`, where a scene names it.
    pub fn begin(&mut self, known: &Models, bundle: Bundle, at: Span) {
        let hash = bundle.hash();
        let path = bundle.path.clone();
        let work = match known.read.get(&path) {
            Some((before, model)) if *before == hash => Work::Done(Arc::clone(model)),
            _ => Work::Running(thread::spawn(move || read(&bundle))),
        };
        self.0.insert(path, (hash, at, work));
    }
}

impl Models {
    /// The model that was last read of a file.
    pub fn of(&self, path: &Path) -> Option<Arc<Model>> {
        self.read.get(path).map(|(_, model)| Arc::clone(model))
    }

    /// Waits for all files and puts together what feeds each name. The names whose files have
    /// errors of their own come second.
    pub fn finish(
        &mut self,
        reading: Reading,
        all: Vec<MeshFiles>,
        diagnostics: &mut Diagnostics,
    ) -> (BTreeMap<String, Arc<Meshes>>, Vec<String>) {
        let mut models = BTreeMap::new();
        for (path, (hash, at, work)) in reading.0 {
            let model = match work {
                Work::Done(model) => Some(model),
                Work::Running(thread) => wait(thread, &path, at, diagnostics).map(Arc::new),
            };
            if let Some(model) = model {
                for note in model.diagnostics.iter() {
                    diagnostics.push(note.clone().see(at, "named here"));
                }
                self.read.insert(path.clone(), (hash, Arc::clone(&model)));
                models.insert(path, model);
            }
        }
        let (mut found, mut failed) = (BTreeMap::new(), Vec::new());
        for MeshFiles { name, entries, paths } in all {
            let parts: Option<Vec<Arc<Model>>> = paths.iter().map(|path| models.get(path.as_ref()?).cloned()).collect();
            match parts.and_then(|parts| self.join(&name, entries, parts, diagnostics)) {
                Some(meshes) => _ = found.insert(name, meshes),
                None => failed.push(name),
            }
        }
        (found, failed)
    }

    /// The same as before if nothing changed, so that nothing goes to the device again.
    fn join(
        &mut self,
        name: &str,
        entries: Vec<MeshEntry>,
        models: Vec<Arc<Model>>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Arc<Meshes>> {
        let mut said: Vec<&str> = Vec::new();
        for (entry, model) in entries.iter().zip(&models) {
            // Several bodies of one file are one matter.
            if !said.contains(&entry.file.value.as_str()) {
                choice(entry, model).into_iter().for_each(|note| diagnostics.push(note));
                said.push(&entry.file.value);
            }
        }
        if let Some(known) = self.joined.get(name)
            && alike(&known.entries, &entries)
            && known.models.len() == models.len()
            && known.models.iter().zip(&models).all(|(a, b)| Arc::ptr_eq(a, b))
        {
            return Some(Arc::clone(&known.meshes));
        }
        let parts: Vec<(&MeshEntry, Arc<Model>)> = entries.iter().zip(models.iter().cloned()).collect();
        match Meshes::new(&parts) {
            Ok(meshes) => {
                let meshes = Arc::new(meshes);
                self.joined.insert(name.to_owned(), Joined { entries, models, meshes: Arc::clone(&meshes) });
                Some(meshes)
            }
            Err(errors) => {
                diagnostics.extend(errors);
                None
            }
        }
    }
}

/// Whether entries say the same, wherever they stand in the file.
fn alike(a: &[MeshEntry], b: &[MeshEntry]) -> bool {
    let values = |all: &[Item<crate::graph::value::Value>]| {
        all.iter().map(|item| (item.name.value.clone(), item.value.clone())).collect::<Vec<_>>()
    };
    let playing = |entry: &MeshEntry| match &entry.playing {
        crate::scene::Playing::Still => None,
        crate::scene::Playing::Plays { animation, loops, start_s } => {
            Some((animation.as_ref().map(|name| name.value.clone()), *loops, *start_s))
        }
    };
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| {
            a.world_from_body == b.world_from_body
                && a.tags == b.tags
                && values(&a.values) == values(&b.values)
                && playing(a) == playing(b)
        })
}

fn wait(
    thread: JoinHandle<Result<Model, Diagnostics>>,
    path: &Path,
    at: Span,
    diagnostics: &mut Diagnostics,
) -> Option<Model> {
    let read = thread.join().unwrap_or_else(|_| {
        // A reader that panics is a fault of this program, and no reason to end a watch.
        Err(Diagnostic::error(Code::ASSET, format!("`{}`: the reader failed", path.display())).into())
    });
    match read {
        Ok(model) => Some(model),
        Err(errors) => {
            for error in errors.0 {
                diagnostics.push(error.see(at, "named here"));
            }
            None
        }
    }
}
