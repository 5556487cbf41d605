//! From files to everything that a picture needs, without a device.

mod gather;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;

use super::assets::Cache;
use super::content::Content;
use super::inputs::{self, Input, Offer};
use super::params::{self, Given, Raw};
use super::sequence::{Track, When};
use super::source::{self, Brings};
use super::viewpoint::Viewpoint;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};
use crate::files::{self, Files, Kind};
use crate::graph::value::Value;
use crate::plan::model::{MemoryRequest, Policy};
use crate::program::{self, Program, missing_file};
use crate::scene::placement::{Placement, Up};
use crate::scene::{Camera, Item, MeshEntry, PointerPath, Scene, framing};
use crate::syntax::{Sp, first_word};

/// The graph that turns light into a picture.
const PRESENT: &str = "parts/present.ron";
/// Names of its parameters on the command line begin so.
const PRESENT_PREFIX: &str = "present.";
/// The input that a scene's environment feeds.
const ENVIRONMENT: &str = "environment";
const DEFAULT_SIZE: [u32; 2] = [1024, 768];

/// What somebody asks to see.
#[derive(Clone, Debug, Default)]
pub struct Job {
    /// A scene or a particle file.
    pub source: PathBuf,
    /// In place of the scene's.
    pub graph: Option<String>,
    /// In place of the scene's: a file, or `name=file`.
    pub particles: Option<String>,
    /// Metres, in place of any other radius.
    pub radius_m: Option<f64>,
    /// What points up in the file of particles or meshes that is named beside a scene or in place of one.
    pub up: Option<Up>,
    /// Metres to a unit of that file.
    pub scale: Option<f64>,
    /// Pixels, in place of the scene's.
    pub size: Option<[u32; 2]>,
    /// Parameters by instance path, in place of the scene's values.
    pub set: Vec<(String, String)>,
    pub eye: Option<[f64; 3]>,
    pub target: Option<[f64; 3]>,
    /// Vertical.
    pub fov_degrees: Option<f64>,
    /// A place that the pointer holds pressed, seen from the camera, in place of the scene's pointers.
    pub pointer: Option<[f64; 3]>,
    /// Coverage stays as alpha, without a backdrop.
    pub transparent: bool,
    /// Instance paths that are wanted besides the picture.
    pub roots: Vec<String>,
    /// Which frame of sequences to begin with.
    pub when: When,
    /// Mesh files, each for an input, as bodies beside the scene's.
    pub meshes: Vec<(String, PathBuf)>,
    /// A picture in place of the scene's environment.
    pub environment: Option<PathBuf>,
    /// Whether statistics are wanted.
    pub stats: bool,
    /// How memory is shared; absent: by what changes.
    pub policy: Option<Policy>,
    /// Bytes of textures and buffers that may be held.
    pub memory_budget: Option<u64>,
    /// One picture after another is made, so that sequences move from each to the next.
    pub plays: bool,
}

impl Job {
    /// Where the numbers of a file stand that is named beside a scene or in place of one.
    pub fn placement(&self) -> Placement {
        Placement::of_file(self.up.unwrap_or_default(), self.scale.unwrap_or(1.0))
    }
}

impl Job {
    /// Whether anything stands beside the scene that its file does not name.
    pub fn has_dropped(&self) -> bool {
        !self.meshes.is_empty() || self.environment.is_some()
    }
}

/// What loading gave.
#[derive(Debug)]
pub struct Loaded {
    /// Absent if anything had an error.
    pub content: Option<Content>,
    pub diagnostics: Diagnostics,
    /// Every file that was read or, where missing, looked for.
    pub read: Vec<PathBuf>,
}

/// Loads a scene with its graph, its files, and the graph that presents it.
pub fn load(files: &dyn Files, sources: &mut Sources, job: &Job, cache: &mut Cache) -> Loaded {
    let mut loader =
        Loader { files, sources, job, cache, diagnostics: Diagnostics::new(), read: vec![job.source.clone()] };
    let content = loader.content();
    let Loader { diagnostics, mut read, .. } = loader;
    read.sort();
    read.dedup();
    let content = content.filter(|_| !diagnostics.has_errors());
    Loaded { content, diagnostics, read }
}

struct Loader<'a> {
    files: &'a dyn Files,
    sources: &'a mut Sources,
    job: &'a Job,
    cache: &'a mut Cache,
    diagnostics: Diagnostics,
    read: Vec<PathBuf>,
}

impl Loader<'_> {
    fn content(&mut self) -> Option<Content> {
        let source = source::read(self.files, self.job, self.sources, &mut self.diagnostics)?;
        let mut scene = source.scene;
        self.needs_a_file(&source.brings);
        self.add_given(&mut scene);
        // Files decode on other threads while the graphs are read.
        let (particles, images) = (self.particles(&scene, source.brings == Brings::Particles), self.images(&scene));
        let (meshes, mut models) = self.meshes(&scene);
        let camera_file = self.camera_file(&scene, &mut models);
        let offer = Offer { particles, images, meshes, models };
        let program = self.graph(&scene);
        let present = self.program(PRESENT, Some(&scene.path));
        let root = program.as_ref().map(|p| &*p.root);
        let decoded = offer.decode(root, self.cache, &mut self.diagnostics);
        let (program, present) = (program?, present?);
        let mut inputs = inputs::connect(&program.root, &scene, &decoded, &mut self.diagnostics);
        let (own, shared) = self.params(&scene, &program, &present);
        let viewport = self.job.size.or(scene.size).unwrap_or(DEFAULT_SIZE);
        let viewpoint = self.viewpoint(&scene, camera_file);
        let camera = self.camera(&scene, viewpoint.as_ref(), &inputs, viewport)?;
        if let Some(at) = self.job.pointer {
            let held = PointerPath::held(camera.eye, DVec3::from_array(at) - camera.eye);
            let pointers = inputs.values_mut().filter(|input| matches!(input, Input::Pointer(_)));
            pointers.for_each(|input| *input = Input::Pointer(held.clone()));
        }
        let present_inputs = self.present_inputs(&present, &scene, &decoded);
        if !scene.path.starts_with(files::LIBRARY) {
            inputs::unused(&scene, &[&program.root, &present.root], &mut self.diagnostics);
        }
        let roots = self.job.roots.clone();
        let (params, present_params) = (own, shared);
        let tracks = decoded.tracks;
        let memory = self.memory(&tracks, &inputs);
        Some(Content {
            program,
            present,
            inputs,
            present_inputs,
            camera,
            viewpoint: viewpoint.filter(|_| self.job.eye.is_none() && self.job.target.is_none()),
            viewport,
            params,
            present_params,
            roots,
            tracks,
            memory,
            stats: self.job.stats,
        })
    }

    /// `--up` and `--scale` are of a file that the command line names; a scene says its own.
    fn needs_a_file(&mut self, brings: &Brings) {
        let said = self.job.up.map(|_| "--up").or(self.job.scale.map(|_| "--scale"));
        if let (Some(said), Brings::Scene, None) = (said, brings, &self.job.particles) {
            let message = format!("`{said}` is of a file that the command line names, and there is none");
            let hint = "in a scene, `up:` and `scale:` stand beside `file:`";
            self.diagnostics.push(Diagnostic::error(Code::USAGE, message).hint(hint));
        }
    }

    /// What somebody gives beside a scene counts as if the scene said it.
    fn add_given(&self, scene: &mut Scene) {
        let span = scene.span;
        let said = |text: String| Sp { value: text, span };
        for (input, path) in &self.job.meshes {
            let entry = MeshEntry::of(said(path.display().to_string()));
            match scene.meshes.iter_mut().find(|item| item.name.value == *input) {
                Some(item) => item.value.push(entry),
                None => scene.meshes.push(Item { name: said(input.clone()), value: vec![entry], span }),
            }
        }
        if let Some(path) = &self.job.environment {
            scene.cube = None;
            scene.textures.retain(|item| item.name.value != ENVIRONMENT);
            let value = said(path.display().to_string());
            scene.textures.push(Item { name: said(ENVIRONMENT.into()), value, span });
        }
    }

    /// What is asked of memory, with the inputs that each picture has others of.
    fn memory(&self, tracks: &[Track], inputs: &BTreeMap<String, Input>) -> MemoryRequest {
        let moving = |(name, input): &(&String, &Input)| {
            let is_played = tracks.iter().any(|t| t.input == **name && t.frames.moves());
            is_played || matches!(input, Input::Meshes(meshes) if meshes.info.animated)
        };
        let moving = inputs.iter().filter(|_| self.job.plays).filter(moving).map(|(name, _)| name.clone()).collect();
        MemoryRequest { policy: self.job.policy, budget: self.job.memory_budget, elsewhere: 0, moving }
    }

    fn graph(&mut self, scene: &Scene) -> Option<Program> {
        match (&self.job.graph, &scene.graph) {
            (Some(name), _) => self.program(&name.clone(), None),
            (None, Some(name)) => {
                // A scene may bear the name of its graph, and means neither itself nor another scene.
                let folder = scene.path.parent();
                let is_scene = folder.is_some_and(|f| self.is_scene(&files::normalize(&f.join(&name.value)), scene));
                let beside = folder.filter(|_| is_scene).unwrap_or(&scene.path);
                if let Err(missing) = files::find(self.files, Kind::Graph, &name.value, Some(beside)) {
                    self.read.extend(missing.tried.iter().cloned());
                    self.diagnostics.push(missing_file(&name.value, Kind::Graph, &missing, Some(name.span)));
                    return None;
                }
                self.program(&name.value, Some(beside))
            }
            (None, None) => {
                let lacks = Diagnostic::error(Code::MISSING_FIELD, "`Scene` lacks the field `graph`")
                    .at(scene.span, "`graph` is missing here")
                    .hint("or say `--graph GRAPH`");
                self.diagnostics.push(lacks);
                None
            }
        }
    }

    fn is_scene(&self, path: &Path, scene: &Scene) -> bool {
        let is_one = |bytes: Arc<[u8]>| std::str::from_utf8(&bytes).is_ok_and(|text| first_word(text) == "Scene");
        path == scene.path || self.files.read(path).is_ok_and(is_one)
    }

    fn program(&mut self, name: &str, beside: Option<&Path>) -> Option<Program> {
        let loaded = program::load(self.files, self.sources, name, beside);
        self.read.extend(loaded.read);
        self.diagnostics.extend(loaded.diagnostics);
        loaded.program
    }

    /// Values of the graph's parameters, and of the presenting graph's.
    fn params(
        &mut self,
        scene: &Scene,
        program: &Program,
        present: &Program,
    ) -> (BTreeMap<String, Value>, BTreeMap<String, Value>) {
        let in_scene = |item: &Item<Value>| Given {
            path: item.name.value.clone(),
            raw: Raw::Value(item.value.clone()),
            span: Some(item.name.span),
            of_another_graph: false,
        };
        let is_its_own =
            self.job.graph.is_none() || scene.graph.as_ref().map(|name| &name.value) == self.job.graph.as_ref();
        let of_another_graph = !is_its_own && scene.graph.is_some();
        let for_graph = |item| Given { of_another_graph, ..in_scene(item) };
        let mut own: Vec<Given> = scene.params.iter().map(for_graph).collect();
        let mut shared: Vec<Given> = scene.present.iter().map(in_scene).collect();
        for (name, value) in &self.job.set {
            let typed = |path: &str| Given {
                path: path.to_owned(),
                raw: Raw::Text(value.clone()),
                span: None,
                of_another_graph: false,
            };
            match name.strip_prefix(PRESENT_PREFIX) {
                Some(path) => shared.push(typed(path)),
                None => own.push(typed(name)),
            }
        }
        if self.job.transparent {
            shared.push(Given {
                path: "transparent".into(),
                raw: Raw::Value(Value::Bool(true)),
                span: None,
                of_another_graph: false,
            });
        }
        let own = params::resolve(&own, program, &mut self.diagnostics);
        (own, params::resolve(&shared, present, &mut self.diagnostics))
    }

    /// The camera of a file that the scene asks for.
    fn viewpoint(&mut self, scene: &Scene, path: Option<PathBuf>) -> Option<Viewpoint> {
        let model = self.cache.models.of(&path?)?;
        let found = Viewpoint::new(&scene.camera_file.as_ref()?.value, &model);
        let mut found = found.map_err(|error| self.diagnostics.push(error)).ok()?;
        found.fov_degrees = self.job.fov_degrees.unwrap_or(found.fov_degrees);
        Some(found)
    }

    /// The scene's camera, else one that frames the first particles; the command line's terms win.
    fn camera(
        &mut self,
        scene: &Scene,
        viewpoint: Option<&Viewpoint>,
        inputs: &BTreeMap<String, Input>,
        viewport: [u32; 2],
    ) -> Option<Camera> {
        let job = self.job;
        let said = scene.camera.as_ref().map(|camera| camera.value);
        let mut camera = match said.or_else(|| viewpoint?.at(0.0)) {
            Some(camera) => camera,
            None => {
                let seen = inputs.values().find_map(|input| match input {
                    Input::Particles(particles) if particles.set.count > 0 => Some(particles),
                    _ => None,
                });
                let (positions, radius) =
                    seen.map_or_else(|| (corners(inputs).into(), 0.0), |p| (p.set.positions(), p.radius_m));
                framing::frame(&positions, radius, viewport, job.fov_degrees.unwrap_or(framing::FOV_DEGREES))
            }
        };
        camera.eye = job.eye.map_or(camera.eye, DVec3::from_array);
        camera.target = job.target.map_or(camera.target, DVec3::from_array);
        camera.fov_degrees = job.fov_degrees.unwrap_or(camera.fov_degrees);
        if let Some(fault) = camera.fault() {
            self.diagnostics.push(Diagnostic::error(Code::USAGE, fault));
            return None;
        }
        Some(camera)
    }

    /// The presenting graph takes the scene's items too, and a light of the default scene where
    /// the scene has none.
    fn present_inputs(
        &mut self,
        present: &Program,
        scene: &Scene,
        decoded: &inputs::Decoded,
    ) -> BTreeMap<String, Input> {
        let mut quiet = Diagnostics::new();
        let mut found = inputs::connect(&present.root, scene, decoded, &mut quiet);
        if let Some(defaults) = source::default_scene(self.sources, &mut self.diagnostics) {
            let others = inputs::connect(&present.root, &defaults, &inputs::Decoded::default(), &mut quiet);
            others.into_iter().for_each(|(name, input)| _ = found.entry(name).or_insert(input));
        }
        found
    }
}

/// The corners of the boxes around all bodies.
fn corners(inputs: &BTreeMap<String, Input>) -> Vec<[f32; 3]> {
    let boxes = inputs.values().filter_map(|input| match input {
        Input::Meshes(meshes) if meshes.info.instances > 0 => Some([meshes.info.min, meshes.info.max]),
        _ => None,
    });
    boxes
        .flat_map(|ends| (0..8).map(move |corner| [0, 1, 2].map(|axis| ends[corner >> axis & 1][axis] as f32)))
        .collect()
}
