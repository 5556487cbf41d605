//! Feeding a graph's inputs from a scene's items of the same names.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use half::f16;
use wgpu_types::TextureUsages;

use super::assets::{Asset, Cache, Particles, Pending, radius_m};
use super::meshes::Meshes;
use super::models::{MeshFiles, Reading};
use super::sequence::{Frames, Track};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span};
use crate::format::TextureFormat;
use crate::graph::model::{Graph, Input as Declared, InputDefault, InputKind};
use crate::graph::rows::Row;
use crate::graph::value::Value;
use crate::plan::model::{InputInfo, Texture};
use crate::scene::image::Image;
use crate::scene::particles::Taken;
use crate::scene::{Light, PointerPath, Scene, find};

/// What feeds an input.
#[derive(Clone, Debug)]
pub enum Input {
    Camera,
    Light(Light),
    Pointer(PointerPath),
    Particles(Arc<Particles>),
    Image(Arc<Image>),
    Meshes(Arc<Meshes>),
    Table(Vec<Row>),
}

/// A particle file of the scene or the command line.
#[derive(Debug)]
pub(super) struct ParticleFile {
    /// Absent: for the graph's only input of particles.
    pub name: Option<String>,
    pub path: PathBuf,
    /// Absent if there is no such file, which was reported.
    pub pending: Option<Pending>,
    /// Metres, where somebody says.
    pub radius_m: Option<f64>,
    pub taken: Taken,
    /// Where somebody says.
    pub bounds: Option<[[f32; 3]; 2]>,
    /// The sequence that the file is a frame of.
    pub sequence: Option<Frames>,
    /// The sequence begins later: nothing shows yet, and this is its first file.
    pub is_early: bool,
}

/// Everything that a scene and the command line offer, files perhaps still being decoded.
#[derive(Debug)]
pub(super) struct Offer {
    pub particles: Vec<ParticleFile>,
    pub images: Vec<ImageFiles>,
    pub meshes: Vec<MeshFiles>,
    pub models: Reading,
}

/// The picture files that feed a texture.
#[derive(Debug)]
pub(super) struct ImageFiles {
    pub name: String,
    /// Absent where there is no such file, which was reported.
    pub pending: Vec<Option<Pending>>,
    /// If they are a cube's, where the scene says so.
    pub cube_at: Option<Span>,
}

/// Decoded files by the names of the inputs that they are for.
#[derive(Debug, Default)]
pub(super) struct Decoded {
    particles: BTreeMap<String, Arc<Particles>>,
    images: BTreeMap<String, Arc<Image>>,
    meshes: BTreeMap<String, Arc<Meshes>>,
    /// Sequences that particles are frames of.
    pub tracks: Vec<Track>,
    /// Names whose file has an error of its own: not missing.
    failed: Vec<String>,
}

impl Offer {
    /// Waits for all files.
    pub fn decode(self, graph: Option<&Graph>, cache: &mut Cache, diagnostics: &mut Diagnostics) -> Decoded {
        let mut decoded = Decoded::default();
        for file in self.particles {
            let ParticleFile { name, path, pending, radius_m: said, taken, bounds, sequence, is_early } = file;
            let name = name.map_or_else(|| only_particles(graph), Ok);
            let asset = pending.and_then(|pending| cache.finish(pending, diagnostics));
            let name = match name {
                Ok(name) => name,
                Err(error) => {
                    diagnostics.push(error);
                    continue;
                }
            };
            let Some(Asset::Particles(set, estimated)) = asset else {
                decoded.failed.push(name);
                continue;
            };
            match radius_m(&path, &set, estimated, said, diagnostics) {
                Ok(radius_m) => {
                    let is_late = sequence.as_ref().is_some_and(Frames::is_late);
                    let none = is_late.then(|| Arc::new(Particles::before(&set, radius_m, bounds)));
                    let shown = match &none {
                        Some(none) if is_early => Arc::clone(none),
                        _ => cache.sized(&path, set, radius_m, bounds),
                    };
                    let input = name.clone();
                    decoded.tracks.extend(sequence.map(|frames| Track {
                        input,
                        frames,
                        taken,
                        radius_m,
                        bounds,
                        none,
                    }));
                    decoded.particles.insert(name, shown);
                }
                Err(error) => {
                    diagnostics.push(error);
                    decoded.failed.push(name);
                }
            }
        }
        for ImageFiles { name, pending, cube_at } in self.images {
            let images: Vec<Arc<Image>> = pending
                .into_iter()
                .filter_map(|pending| match cache.finish(pending?, diagnostics) {
                    Some(Asset::Image(image)) => Some(image),
                    _ => None,
                })
                .collect();
            let image = match cube_at {
                None => images.into_iter().next(),
                Some(span) => cache.cube(images, span, diagnostics),
            };
            match image {
                Some(image) => _ = decoded.images.insert(name, image),
                None => decoded.failed.push(name),
            }
        }
        let (meshes, failed) = cache.models.finish(self.models, self.meshes, diagnostics);
        decoded.meshes = meshes;
        decoded.failed.extend(failed);
        decoded
    }
}

/// The name of a graph's one input of particles, or of the one that it cannot do without.
fn only_particles(graph: Option<&Graph>) -> Result<String, Diagnostic> {
    let Some(graph) = graph else { return Ok("particles".into()) };
    let takes = graph.inputs.iter().filter(|i| matches!(i.kind, InputKind::Particles { .. }));
    let (needed, others): (Vec<_>, Vec<_>) = takes.partition(|i| !i.optional);
    let takes = if needed.len() == 1 { needed } else { [needed, others].concat() };
    let names: Vec<&str> = takes.iter().map(|i| i.name.value.as_str()).collect();
    let path = graph.path.display();
    match names.as_slice() {
        [name] => Ok((*name).to_owned()),
        [] => Err(Diagnostic::warning(Code::UNUSED, format!("`{path}` takes no particles: the file is not used"))),
        [first, ..] => {
            let message = format!("`{path}` takes several kinds of particles: {}", names.join(", "));
            let hint = format!("say which: `--particles {first}=FILE`");
            Err(Diagnostic::error(Code::USAGE, message).hint(hint))
        }
    }
}

/// Feeds every input of `graph`, and reports those that nothing feeds.
pub(super) fn connect(
    graph: &Graph,
    scene: &Scene,
    decoded: &Decoded,
    diagnostics: &mut Diagnostics,
) -> BTreeMap<String, Input> {
    let mut inputs = BTreeMap::new();
    for declared in &graph.inputs {
        let name = &declared.name.value;
        match offered(declared, scene, decoded) {
            Some(input) => _ = inputs.insert(name.clone(), input),
            None if decoded.failed.contains(name) => {}
            None if has_default(declared, scene) => {
                let default = declared.default.as_ref().map(|default| Input::of_default(default, &declared.kind));
                inputs.extend(default.map(|input| (name.clone(), input)));
            }
            None => {
                if let Some(problem) = missing(declared, graph, scene) {
                    diagnostics.push(problem);
                }
            }
        }
    }
    inputs
}

/// Whether the graph says what feeds an input that the scene has no item for. That there are no particles holds only
/// for scenes of meshes: in others somebody forgot them.
fn has_default(declared: &Declared, scene: &Scene) -> bool {
    let is_other = scene.items().iter().any(|(_, item)| item.value == declared.name.value);
    match &declared.default {
        None => false,
        Some(InputDefault::NoParticles) => !is_other && !scene.meshes.is_empty(),
        Some(_) => !is_other,
    }
}

fn offered(declared: &Declared, scene: &Scene, decoded: &Decoded) -> Option<Input> {
    let name = &declared.name.value;
    match &declared.kind {
        InputKind::Camera => Some(Input::Camera),
        InputKind::Pointer => {
            let path = find(&scene.pointers, name).map(|item| item.value.clone());
            Some(Input::Pointer(path.unwrap_or_default()))
        }
        InputKind::Light => find(&scene.lights, name).map(|item| Input::Light(item.value)),
        InputKind::Particles { .. } => decoded.particles.get(name).cloned().map(Input::Particles),
        InputKind::Texture { .. } => decoded.images.get(name).cloned().map(Input::Image),
        InputKind::Table => find(&scene.tables, name).map(|item| Input::Table(item.value.clone())),
        InputKind::Meshes { .. } => decoded.meshes.get(name).cloned().map(Input::Meshes),
        InputKind::Buffer | InputKind::Counted => None,
    }
}

/// The words of a scene that feed a kind of input.
fn section(kind: &InputKind) -> Option<(&'static str, &'static str)> {
    match kind {
        InputKind::Light => Some(("light", "lights")),
        InputKind::Particles { .. } => Some(("particles", "particles")),
        InputKind::Meshes { .. } => Some(("meshes", "meshes")),
        InputKind::Texture { .. } => Some(("texture", "textures")),
        InputKind::Table => Some(("table", "tables")),
        _ => None,
    }
}

fn missing(declared: &Declared, graph: &Graph, scene: &Scene) -> Option<Diagnostic> {
    let name = &declared.name.value;
    let kind = declared.kind.name();
    let items = scene.items();
    let other = items.iter().find(|(_, item)| item.value == *name);
    if let Some((found, item)) = other {
        let message =
            format!("input `{name}` of `{}` is {kind}, and the scene's `{name}` is not", graph.path.display());
        let error = Diagnostic::error(Code::WRONG_KIND, message).at(item.span, format!("this is under {found}"));
        return Some(error.see(declared.span, format!("{kind} is declared here")));
    }
    if declared.optional {
        return None;
    }
    let message = format!("nothing feeds the input `{name}` of `{}`", graph.path.display());
    let error = Diagnostic::error(Code::MISSING_INPUT, message)
        .at(scene.span, format!("the scene has no `{name}`"))
        .see(declared.span, format!("{kind} is declared here"));
    let Some((word, section)) = section(&declared.kind) else {
        return Some(error.hint(format!("scenes cannot give {kind}: such a graph is a part of others")));
    };
    let same = items.iter().filter(|(found, _)| *found == word).map(|(_, item)| item.value.as_str());
    let error = error.nearest(name, same);
    Some(match word {
        "particles" => error.hint(format!("give it with `--particles FILE`, or under `{section}:` in the scene")),
        _ => error.hint(format!("give it under `{section}:` in the scene")),
    })
}

/// A warning for each item that nothing takes.
pub(super) fn unused(scene: &Scene, takers: &[&Graph], diagnostics: &mut Diagnostics) {
    let inputs: Vec<&str> = takers.iter().flat_map(|g| &g.inputs).map(|i| i.name.value.as_str()).collect();
    for (kind, name) in scene.items() {
        // A backdrop and a sun are there for whichever graph comes.
        if !inputs.contains(&name.value.as_str()) {
            let message = format!("no input takes the scene's {kind} `{}`", name.value);
            let warning = Diagnostic::warning(Code::UNUSED, message).at(name.span, "not used");
            diagnostics.push(warning.nearest(&name.value, inputs.iter().copied()));
        }
    }
}

impl Input {
    /// What a graph says of an input that nothing else feeds.
    fn of_default(default: &InputDefault, kind: &InputKind) -> Self {
        match default {
            InputDefault::Light { direction, color, intensity } => Input::Light(Light {
                direction: DVec3::from_array(*direction),
                color: DVec3::from_array(*color),
                intensity: *intensity,
            }),
            InputDefault::Texture(color) => {
                let texel = color.map(|channel| f16::from_f64(channel.clamp(-65504.0, 65504.0)));
                Input::Image(Arc::new(Image { width: 1, height: 1, texels: vec![texel], clipped: 0 }))
            }
            InputDefault::NoParticles => {
                let names = match kind {
                    InputKind::Particles { attributes } => attributes.iter().map(|a| a.name.value.as_str()).collect(),
                    _ => Vec::new(),
                };
                Input::Particles(Arc::new(Particles::none(&names)))
            }
            InputDefault::Table(rows) => Input::Table(rows.clone()),
        }
    }

    /// What planning needs to know of it.
    pub fn info(&self) -> InputInfo {
        match self {
            Input::Camera => InputInfo::Camera,
            Input::Light(_) => InputInfo::Light,
            Input::Pointer(_) => InputInfo::Pointer,
            Input::Meshes(meshes) => InputInfo::Meshes(meshes.info.clone()),
            Input::Table(rows) => InputInfo::Table { rows: rows.clone() },
            Input::Image(image) => InputInfo::Texture(Texture {
                format: TextureFormat::Rgba16Float,
                width: image.width,
                height: image.height,
                layers: 1,
                is_3d: false,
                mips: 1,
                samples: 1,
                usages: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            }),
            Input::Particles(particles) => InputInfo::Particles {
                count: particles.set.count as u64,
                radius: particles.radius_m,
                min: particles.min.map(f64::from),
                max: particles.max.map(f64::from),
                attributes: particles.set.attributes.iter().map(|a| (a.name.clone(), a.components as u32)).collect(),
            },
        }
    }

    /// The live value of a field that is the same for all of a frame.
    pub fn field(&self, field: &str, camera: &crate::scene::Camera, viewport: [u32; 2]) -> Option<Value> {
        match self {
            Input::Camera => camera.field(field, viewport),
            Input::Light(light) => light.field(field),
            _ => None,
        }
    }

    /// Whether both are the same memory, so that nothing needs to go to the device again.
    pub fn is_same(&self, other: &Input) -> bool {
        match (self, other) {
            (Input::Particles(a), Input::Particles(b)) => Arc::ptr_eq(a, b),
            (Input::Image(a), Input::Image(b)) => Arc::ptr_eq(a, b),
            (Input::Meshes(a), Input::Meshes(b)) => Arc::ptr_eq(a, b),
            (Input::Table(a), Input::Table(b)) => a == b,
            _ => false,
        }
    }
}
