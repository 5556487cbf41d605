//! `meniscus check`: graphs, scenes and shaders, without a GPU.

use std::collections::BTreeMap;
use std::path::Path;

use super::args::{CheckArgs, CheckFormat};
use super::report::{Exit, print, report, say};
use crate::check::{self, Device};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity, Sources, to_json};
use crate::files::{DiskFiles, Files as _};
use crate::host::{Cache, Job, load};
use crate::program::{self, Program};
use crate::syntax;
use crate::{plan, shader};

pub fn run(args: &CheckArgs) -> Exit {
    let mut sources = Sources::new();
    let mut found = Diagnostics::new();
    let device = match args.device.as_deref().map(device).transpose() {
        Ok(device) => device,
        Err(error) => return report(&error.into(), &sources),
    };
    for file in &args.files {
        found.extend(check_file(file, device.as_ref(), &mut sources));
    }
    let exit = match args.format {
        CheckFormat::Text => report(&found, &sources),
        CheckFormat::Json => match print(&format!("{:#}\n", to_json(&found, &sources))) {
            Exit::Done => Exit::of(&found),
            failed => failed,
        },
    };
    let warned = found.count(Severity::Warning) > 0;
    match exit {
        Exit::Done if args.deny_warnings && warned => Exit::Findings,
        Exit::Done if args.format == CheckFormat::Text && !warned => {
            let files = args.files.len();
            say(&format!("{files} file{} checked: nothing wrong", if files == 1 { "" } else { "s" }));
            Exit::Done
        }
        other => other,
    }
}

/// A device by its name, or from a file.
fn device(name: &str) -> Result<Device, Diagnostic> {
    if let Some(device) = Device::named(name) {
        return Ok(device);
    }
    let bytes = std::fs::read(name).map_err(|error| {
        let message = format!("`--device {name}`: the file cannot be read: {error}");
        Diagnostic::error(Code::FILE_UNREADABLE, message).hint("or say `core` or `native`")
    })?;
    Device::from_json(name, &String::from_utf8_lossy(&bytes))
}

/// Everything that is wrong with a program, for a device if one is asked for.
fn check_program(program: &Program, device: Option<&Device>) -> Diagnostics {
    device.map_or_else(|| check::check(program), |device| check::check_on(program, device))
}

/// Everything that is wrong with a file and with what it names.
fn check_file(path: &Path, device: Option<&Device>, sources: &mut Sources) -> Diagnostics {
    match kind(path) {
        Ok(FileKind::Shader) => check_shader(path, device, sources),
        Ok(FileKind::Scene) => check_scene(path, device, sources),
        Ok(FileKind::Graph) => {
            let loaded = program::load(&DiskFiles, sources, &name(path), None);
            let mut found = loaded.diagnostics;
            if let Some(program) = &loaded.program {
                found.extend(check_program(program, device));
            }
            found
        }
        Err(error) => error.into(),
    }
}

/// A shader by itself: that it is right, and that the device has what it needs.
fn check_shader(path: &Path, device: Option<&Device>, sources: &mut Sources) -> Diagnostics {
    let loaded = shader::load(&DiskFiles, sources, &name(path), None);
    let mut found = loaded.diagnostics;
    if let (Some(module), Some(device)) = (&loaded.module, device) {
        device.lacking(module).into_iter().for_each(|lacking| found.push(lacking));
    }
    found
}

/// The scene, its files and its graph, and the plan for just this scene.
fn check_scene(path: &Path, device: Option<&Device>, sources: &mut Sources) -> Diagnostics {
    let job = Job { source: path.to_owned(), ..Job::default() };
    let loaded = load(&DiskFiles, sources, &job, &mut Cache::default());
    let mut found = loaded.diagnostics;
    if let Some(content) = &loaded.content {
        found.extend(check_program(&content.program, device));
        let on = device.cloned().unwrap_or_else(Device::anything);
        let request = content.request(on.features, on.limits, &BTreeMap::new());
        match plan::instantiate(&content.program, &request) {
            Ok(plan) => found.extend(plan.warnings),
            // A warning of the variants that is an error here is told as the error.
            Err(errors) => found.extend(device.map_or(errors.clone(), |device| device.explained(errors))),
        }
    }
    found
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    Graph,
    Scene,
    Shader,
}

/// What a file is: by its extension, and RON by its first word.
pub fn kind(path: &Path) -> Result<FileKind, Diagnostic> {
    let end = path.extension().and_then(|end| end.to_str()).unwrap_or_default().to_ascii_lowercase();
    let shown = path.display();
    if path.is_dir() {
        return Err(Diagnostic::error(Code::FILE_UNREADABLE, format!("`{shown}` is a folder"))
            .hint("name the files in it, such as `graphs/*.ron`"));
    }
    match end.as_str() {
        "wgsl" => Ok(FileKind::Shader),
        "ron" => Ok(if first_word(path).as_deref() == Some("Scene") { FileKind::Scene } else { FileKind::Graph }),
        _ => Err(Diagnostic::error(Code::USAGE, format!("`{shown}` is no graph, scene (.ron) or shader (.wgsl)"))),
    }
}

/// The word before the bracket that a RON file holds. Faults are told when it is read in earnest.
fn first_word(path: &Path) -> Option<String> {
    let bytes = DiskFiles.read(path).ok()?;
    let mut sources = Sources::new();
    let file = syntax::add_bytes(&mut sources, path, &bytes).ok()?;
    let node = syntax::parse(&sources, file, &mut Diagnostics::new())?;
    node.as_tagged()?.name.as_ref().map(|name| name.value.clone())
}

/// A path as the loaders take it.
pub fn name(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
