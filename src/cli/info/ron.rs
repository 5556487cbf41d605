//! What a scene names, and what a graph takes: its inputs, its parameters with those of its parts, and its outputs.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value as Json, json};

use super::file::Told;
use crate::diagnostic::{Diagnostics, Sources};
use crate::files::{DiskFiles, Files as _};
use crate::graph::model::{Input, Param, ParamKind};
use crate::host::{named, params};
use crate::program;
use crate::scene::{self, Scene};
use crate::syntax::first_word;

/// A scene or a graph, by its first word.
pub(super) fn tell(path: &Path, sources: &mut Sources, found: &mut Diagnostics) -> Option<Told> {
    // Else perhaps one of the program's own.
    if !DiskFiles.exists(path) {
        return of_graph(path, sources, found);
    }
    let bytes = named(&DiskFiles, path).map_err(|error| found.push(error)).ok()?;
    let is_graph = std::str::from_utf8(&bytes).is_ok_and(|text| first_word(text) == "Graph");
    if is_graph {
        return of_graph(path, sources, found);
    }
    let scene = scene::read(path, &bytes, sources, found)?;
    Some(of_scene(&scene))
}

fn of_scene(scene: &Scene) -> Told {
    let mut text = format!("{}: scene\n", scene.path.display());
    scene.about.iter().for_each(|about| _ = writeln!(text, "  {about}"));
    let graph = scene.graph.as_ref().map(|name| name.value.clone());
    graph.iter().for_each(|name| _ = writeln!(text, "  graph: {name}"));
    let width = scene.items().iter().map(|(_, name)| name.value.chars().count()).max().unwrap_or(0);
    let mut items = Vec::new();
    for (kind, name) in scene.items() {
        let files = files_of(scene, &name.value);
        _ = writeln!(text, "    {:width$}  {kind:9}  {}", name.value, files.join(", "));
        items.push(json!({"name": name.value, "kind": kind, "files": files}));
    }
    let camera = scene.camera_file.as_ref().map(|camera| camera.value.entry.file.value.clone());
    camera.iter().for_each(|file| _ = writeln!(text, "  camera: of {file}"));
    if scene.camera.is_none() && camera.is_none() {
        text.push_str("  no camera: the particles, or the meshes, are framed\n");
    }
    for param in &scene.params {
        _ = writeln!(text, "  {} = {}", param.name.value, param.value);
    }
    let params: Json = scene.params.iter().map(|p| (p.name.value.clone(), json!(p.value.to_string()))).collect();
    let json = json!({
        "file": scene.path.display().to_string(),
        "scene": {"about": scene.about, "graph": graph, "items": items, "params": params},
    });
    Told { text, json }
}

/// The files that an item is made of, as the scene names them.
fn files_of(scene: &Scene, name: &str) -> Vec<String> {
    let of = |file: &crate::syntax::Sp<String>| file.value.clone();
    let particles = scene::find(&scene.particles, name).map(|item| vec![of(&item.value.file)]);
    let meshes = || scene::find(&scene.meshes, name).map(|item| item.value.iter().map(|body| of(&body.file)).collect());
    let picture = || scene::find(&scene.textures, name).map(|item| vec![of(&item.value)]);
    let cube =
        || scene.cube.as_ref().filter(|c| c.name.value == name).map(|c| c.value.files().iter().map(of).collect());
    particles.or_else(meshes).or_else(picture).or_else(cube).unwrap_or_default()
}

fn of_graph(path: &Path, sources: &mut Sources, found: &mut Diagnostics) -> Option<Told> {
    let loaded = program::load(&DiskFiles, sources, &path.display().to_string(), None);
    found.extend(loaded.diagnostics);
    let program = loaded.program?;
    let root = &program.root;
    let mut text = format!("{}: graph\n", path.display());
    root.about.iter().for_each(|about| _ = writeln!(text, "  {about}"));
    text.push_str("  inputs:\n");
    let width = root.inputs.iter().map(|input| input.name.value.chars().count()).max().unwrap_or(0);
    for input in &root.inputs {
        _ = writeln!(text, "    {:width$}  {}{}", input.name.value, input.kind.name(), need(input));
    }
    let declared = params::declared(&program);
    if !declared.is_empty() {
        text.push_str("  parameters, for `--set NAME=VALUE` and `params:`:\n");
    }
    let width = declared.keys().map(|path| path.chars().count()).max().unwrap_or(0);
    for (path, param) in &declared {
        _ = writeln!(text, "    {path:width$}  {}", described(param));
    }
    let outputs: Vec<&str> = root.outputs.iter().map(|output| output.name.value.as_str()).collect();
    _ = writeln!(text, "  outputs: {}", outputs.join(", "));
    let inputs = root.inputs.iter().map(|input| {
        let needed = !input.optional && input.default.is_none();
        json!({"name": input.name.value, "kind": input.kind.name(), "needed": needed})
    });
    let json = json!({
        "file": path.display().to_string(),
        "graph": {
            "about": root.about, "inputs": inputs.collect::<Vec<Json>>(), "outputs": outputs,
            "params": declared.iter().map(|(path, param)| as_json(path, param)).collect::<Vec<Json>>(),
        },
    });
    Some(Told { text, json })
}

fn need(input: &Input) -> &'static str {
    match (input.optional, &input.default) {
        (true, _) => ", optional",
        (false, Some(_)) => ", has a default",
        (false, None) => "",
    }
}

/// Kind, default, range, unit and text of a parameter.
fn described(param: &Param) -> String {
    let mut text = match &param.kind {
        ParamKind::Choice(words) => words.iter().map(|word| word.value.as_str()).collect::<Vec<_>>().join(" | "),
        kind => kind.name().to_owned(),
    };
    if let Some(default) = &param.default {
        _ = write!(text, " = {}", default.value);
    }
    if let (Some(min), Some(max)) = (&param.min, &param.max) {
        _ = write!(text, " ({} to {})", min.value, max.value);
    }
    param.unit.iter().for_each(|unit| _ = write!(text, " {unit}"));
    param.about.iter().for_each(|about| _ = write!(text, ": {about}"));
    text
}

fn as_json(path: &str, param: &Param) -> Json {
    let value =
        |value: &Option<crate::syntax::Sp<crate::graph::value::Value>>| value.as_ref().map(|v| v.value.to_string());
    json!({
        "name": path, "kind": param.kind.name(), "default": value(&param.default), "min": value(&param.min),
        "max": value(&param.max), "unit": param.unit, "about": param.about,
    })
}
