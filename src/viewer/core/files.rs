//! Opening what was dropped, and putting what was changed back into the scene file.

use std::path::{Path, PathBuf};

use super::Core;
use crate::diagnostic::{Diagnostics, Sources};
use crate::files::library_file;
use crate::graph::model::{Input as Declared, InputKind};
use crate::graph::value::Value;
use crate::host::{Input, Job};
use crate::output::Output;
use crate::scene::placement::Up;
use crate::scene::{self, edit};
use crate::viewer::dropped::{Kind, kind_of};
use crate::viewer::params::PRESENT;
use crate::viewer::state::short;

impl Core {
    /// Opens a file that was dropped or picked.
    pub(super) fn open_path(&mut self, path: PathBuf) {
        let before = self.state.job.clone();
        let size = before.as_ref().and_then(|job| job.size);
        match (kind_of(&path), before) {
            (Err(why), _) => self.state.say(why),
            (Ok(Kind::Scene), _) => self.open(Job { source: path, size, ..Job::default() }),
            (Ok(Kind::Particles), before) => {
                // A graph that was dropped or named before goes on drawing.
                let graph = before.and_then(|job| job.graph);
                self.open(Job { source: path, graph, size, ..Job::default() });
            }
            (Ok(Kind::Graph), Some(before)) => {
                let graph = Some(absolute(&path).display().to_string());
                self.reopen(Job { graph, ..before });
            }
            (Ok(Kind::Mesh), Some(before)) => self.add_mesh(before, &path),
            (Ok(Kind::Picture), Some(before)) => {
                self.state.say(format!("{} is the environment now", short(&path)));
                self.reopen(Job { environment: Some(absolute(&path)), ..before });
            }
            (Ok(Kind::Graph), None) => {
                self.state.say("a graph draws something: drop a scene or particles first, then the graph");
            }
            (Ok(Kind::Mesh), None) => self.open(Job { source: path, size, ..Job::default() }),
            (Ok(Kind::Picture), None) => {
                self.state.say("a picture is an environment: drop a scene or particles first, then the picture");
            }
        }
    }

    /// A mesh becomes a body beside those of the scene.
    fn add_mesh(&mut self, before: Job, path: &Path) {
        let root = self.session.content().map(|content| &content.program.root);
        let takes = |input: &&Declared| matches!(input.kind, InputKind::Meshes { .. });
        let Some(input) = root.and_then(|root| root.inputs.iter().find(takes)) else {
            let graph = root.map_or_else(|| "nothing that is built".into(), |root| format!("`{}`", short(&root.path)));
            self.state.say(format!("{graph} takes no meshes"));
            return;
        };
        let given = (input.name.value.clone(), absolute(path));
        let mut meshes = before.meshes.clone();
        // One that did not work goes when another comes.
        if self.state.findings.as_ref().is_some_and(|findings| findings.is_stale) {
            meshes.pop();
        }
        meshes.retain(|other| *other != given);
        meshes.push(given);
        self.state.say(format!("{} stands in the scene", short(path)));
        self.reopen(Job { meshes, ..before });
    }

    /// Takes away what was dropped onto the scene.
    pub(super) fn take_away(&mut self, path: &Path) {
        let Some(mut job) = self.state.job.clone() else { return };
        job.meshes.retain(|(_, other)| other != path);
        job.environment = job.environment.filter(|other| other != path);
        job.graph = job.graph.filter(|other| Path::new(other) != path);
        self.reopen(job);
    }

    /// Puts changed parameters into the scene file, and what was dropped onto the scene.
    pub(super) fn save_changes(&mut self) {
        let declared: Vec<&String> = self.state.groups.iter().flat_map(|g| &g.params).map(|p| &p.path).collect();
        let changed = self.state.overrides.iter().filter(|(path, _)| declared.contains(path));
        let changed: Vec<(String, Value)> = changed.map(|(path, value)| (path.clone(), value.clone())).collect();
        let Some(job) = self.state.job.clone() else { return };
        let dropped = job.meshes.len() + usize::from(job.environment.is_some());
        if changed.is_empty() && dropped == 0 {
            self.state.say("nothing was changed");
            return;
        }
        let saved = self.save(&|text| {
            let text = changed.iter().try_fold(text.to_owned(), |text, (path, value)| {
                let (section, name) = match path.strip_prefix(PRESENT) {
                    Some(name) => ("present", name),
                    None => ("params", path.as_str()),
                };
                edit::set_entry(&text, section, name, &edit::written(value))
            })?;
            let text = job.meshes.iter().try_fold(text, |text, (input, path)| {
                edit::add_item(&text, "meshes", input, &named(path, &job.source))
            })?;
            match &job.environment {
                Some(path) => edit::set_field(&text, "environment", &named(path, &job.source)),
                None => Ok(text),
            }
        });
        match saved {
            Ok(path) => {
                let counted = |count: usize, what: &str| {
                    let plural = if count == 1 { "" } else { "s" };
                    (count > 0).then(|| format!("{count} {what}{plural}"))
                };
                let parts: Vec<String> =
                    [counted(changed.len(), "value"), counted(dropped, "file")].into_iter().flatten().collect();
                self.state.say(format!("{} saved to {}", parts.join(" and "), short(&path)));
                self.forget_given(&changed);
            }
            Err(why) => self.state.say(format!("nothing was saved: {why}")),
        }
    }

    /// Puts the camera into the scene file.
    pub(super) fn save_camera(&mut self) {
        let Some(camera) = self.state.camera else { return };
        match self.save(&|text| edit::set_field(text, "camera", &edit::camera(&camera))) {
            Ok(path) => {
                // What was saved is the scene's camera from now on.
                self.state.home = Some(camera);
                self.state.say(format!("the camera was saved to {}", short(&path)));
            }
            Err(why) => self.state.say(format!("nothing was saved: {why}")),
        }
    }

    /// What the scene has now is not given beside it any more: values of the command line would hide those that were
    /// saved, and a body would stand there twice.
    fn forget_given(&mut self, saved: &[(String, Value)]) {
        let Some(mut job) = self.state.job.clone() else { return };
        let before = (job.set.len(), job.meshes.len(), job.environment.is_some());
        job.set.retain(|(name, _)| saved.iter().all(|(path, _)| path != name));
        job.meshes.clear();
        job.environment = None;
        if before != (job.set.len(), 0, false) {
            self.reopen(job);
        }
    }

    /// Edits the scene's text as it is on the disk now, and puts it back whole. Particles that came
    /// without a scene get one beside them.
    fn save(&mut self, edit: &dyn Fn(&str) -> Result<String, String>) -> Result<PathBuf, String> {
        let job = self.state.job.clone().ok_or("nothing is open")?;
        let is_scene = job.source.extension().is_some_and(|end| end.eq_ignore_ascii_case("ron"));
        if is_scene {
            let text = std::fs::read_to_string(&job.source).map_err(|error| error.to_string())?;
            write(&job.source, &edit(&text)?)?;
            return Ok(job.source);
        }
        let path = job.source.with_extension("ron");
        if path.exists() {
            return Err(format!("`{}` is there already: open that scene, or move it away", short(&path)));
        }
        write(&path, &edit(&self.new_scene(&job)?)?)?;
        self.reopen(Job { source: path.clone(), graph: None, radius_m: None, up: None, scale: None, ..job });
        Ok(path)
    }

    /// The text of a scene for particles that have none.
    fn new_scene(&self, job: &Job) -> Result<String, String> {
        let text = library_file(Path::new("scenes/default.ron")).ok_or("this build carries no default scene")?;
        let text = std::str::from_utf8(text).map_err(|error| error.to_string())?;
        // What the shipped file says of itself is not true of this one.
        let text = text.find("Scene(").map_or(text, |at| &text[at..]);
        let text = edit::set_field(text, "about", &format!("{:?}", format!("Particles of {}", short(&job.source))))?;
        let inputs = self.session.content().map(|content| &content.inputs);
        let is_mesh = matches!(kind_of(&job.source), Ok(Kind::Mesh));
        let name = inputs.into_iter().flatten().find_map(|(name, input)| match input {
            Input::Particles(_) if !is_mesh => Some(name.as_str()),
            Input::Meshes(_) if is_mesh => Some(name.as_str()),
            _ => None,
        });
        let file = format!("{:?}", short(&job.source));
        let radius = job.radius_m.map(|r| format!(", radius: {r:?}")).unwrap_or_default();
        let up = job.up.filter(|up| *up == Up::Z).map(|_| ", up: Z").unwrap_or_default();
        let scale = job.scale.map(|s| format!(", scale: {s:?}")).unwrap_or_default();
        let more = [radius, up.to_owned(), scale].concat();
        let source = if more.is_empty() { file } else { format!("(file: {file}{more})") };
        let kind = if is_mesh { "meshes" } else { "particles" };
        let mut text = edit::set_entry(&text, kind, name.unwrap_or(kind), &source)?;
        if let Some(graph) = &job.graph {
            text = edit::set_field(&text, "graph", &format!("{graph:?}"))?;
        }
        match self.state.camera {
            Some(camera) => edit::set_field(&text, "camera", &edit::camera(&camera)),
            None => Ok(text),
        }
    }
}

/// A file as a scene names it: from the scene's folder if it lies below it.
fn named(path: &Path, scene: &Path) -> String {
    let (path, scene) = (absolute(path), absolute(scene));
    let below = scene.parent().and_then(|folder| path.strip_prefix(folder).ok()).unwrap_or(&path);
    let parts: Vec<_> = below.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    let text = if below.is_absolute() { below.display().to_string() } else { parts.join("/") };
    format!("{text:?}")
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Writes a scene's text, if it still is one, in place of what was there.
fn write(path: &Path, text: &str) -> Result<(), String> {
    let mut found = Diagnostics::new();
    scene::read(path, text.as_bytes(), &mut Sources::new(), &mut found);
    if found.has_errors() {
        let why = found.iter().next().map(|d| d.message.clone()).unwrap_or_default();
        return Err(format!("the scene would no longer be one: {why}"));
    }
    // A link stays a link: what it leads to is written.
    let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let output = Output::reserve(&target).map_err(|error| error.message)?;
    output.write(text.as_bytes()).map_err(|error| error.message)
}
