//! Opening what is dropped, and putting what was changed back into the scene file.

use std::path::{Path, PathBuf};

use super::Core;
use crate::diagnostic::{Diagnostics, Sources};
use crate::files::library_file;
use crate::graph::value::Value;
use crate::host::{Input, Job};
use crate::output::Output;
use crate::scene::{self, edit, particles};
use crate::viewer::params::PRESENT;
use crate::viewer::state::short;

/// What a file can be opened as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Scene,
    Graph,
    Particles,
}

/// What a file is, by its name and, of RON, by its first word.
///
/// # Errors
/// If it is nothing that can be opened; the text says so.
pub fn kind_of(path: &Path) -> Result<Kind, String> {
    let shown = short(path);
    if path.is_dir() {
        return Err(format!("`{shown}` is a folder: drop a file of it"));
    }
    if path.extension().is_some_and(|end| end.eq_ignore_ascii_case("ron")) {
        let text = std::fs::read_to_string(path).map_err(|error| format!("`{shown}` cannot be read: {error}"))?;
        return Ok(if first_word(&text) == "Graph" { Kind::Graph } else { Kind::Scene });
    }
    if particles::known_extension(path) {
        return Ok(Kind::Particles);
    }
    Err(format!("`{shown}` is no scene, graph or particle file"))
}

/// The first word of a text in RON, behind comments.
fn first_word(text: &str) -> &str {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let end = if rest.starts_with("//") {
            rest.find('\n')
        } else if rest.starts_with("/*") {
            rest.find("*/").map(|at| at + 1)
        } else if rest.starts_with("#!") {
            rest.find(']')
        } else {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            return &rest[..end];
        };
        rest = end.map_or("", |at| rest[at + 1..].trim_start());
    }
}

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
                let graph = Some(path.display().to_string());
                self.reopen(Job { graph, ..before });
            }
            (Ok(Kind::Graph), None) => {
                self.state.say("a graph draws something: drop a scene or particles first, then the graph");
            }
        }
    }

    /// Puts changed parameters into the scene file.
    pub(super) fn save_params(&mut self) {
        let declared: Vec<&String> = self.state.groups.iter().flat_map(|g| &g.params).map(|p| &p.path).collect();
        let changed = self.state.overrides.iter().filter(|(path, _)| declared.contains(path));
        let changed: Vec<(String, Value)> = changed.map(|(path, value)| (path.clone(), value.clone())).collect();
        if changed.is_empty() {
            self.state.say("no parameter was changed");
            return;
        }
        let count = changed.len();
        let saved = self.save(&|text| {
            changed.iter().try_fold(text.to_owned(), |text, (path, value)| {
                let (section, name) = match path.strip_prefix(PRESENT) {
                    Some(name) => ("present", name),
                    None => ("params", path.as_str()),
                };
                edit::set_entry(&text, section, name, &edit::written(value))
            })
        });
        let plural = if count == 1 { "" } else { "s" };
        match saved {
            Ok(path) => {
                self.state.say(format!("{count} value{plural} saved to {}", short(&path)));
                self.forget_typed(&changed);
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

    /// Values of the command line would hide those that were saved.
    fn forget_typed(&mut self, saved: &[(String, Value)]) {
        let Some(mut job) = self.state.job.clone() else { return };
        let before = job.set.len();
        job.set.retain(|(name, _)| saved.iter().all(|(path, _)| path != name));
        if job.set.len() != before {
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
        self.reopen(Job { source: path.clone(), graph: None, radius_m: None, ..job });
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
        let name = inputs.into_iter().flatten().find_map(|(name, input)| match input {
            Input::Particles(_) => Some(name.as_str()),
            _ => None,
        });
        let file = format!("{:?}", short(&job.source));
        let source = job.radius_m.map(|r| format!("(file: {file}, radius: {r:?})")).unwrap_or(file);
        let mut text = edit::set_entry(&text, "particles", name.unwrap_or("particles"), &source)?;
        if let Some(graph) = &job.graph {
            text = edit::set_field(&text, "graph", &format!("{graph:?}"))?;
        }
        match self.state.camera {
            Some(camera) => edit::set_field(&text, "camera", &edit::camera(&camera)),
            None => Ok(text),
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_stands_behind_comments() {
        assert_eq!(first_word("// a\n/* b */ Graph(x: 1)"), "Graph");
        assert_eq!(first_word("\u{feff}#![enable(x)]\nScene ("), "Scene");
        assert_eq!(first_word("// only"), "");
    }
}
