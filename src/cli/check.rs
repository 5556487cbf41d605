//! `meniscus check`: graphs, scenes and shaders, without a GPU.

use std::collections::BTreeMap;
use std::path::Path;

use super::args::{CheckArgs, CheckFormat};
use super::report::{Exit, print, report, say};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity, Sources, to_json};
use crate::files::{DiskFiles, Files as _};
use crate::host::{Cache, Job, load};
use crate::syntax;
use crate::{check, plan, program, shader};

pub fn run(args: &CheckArgs) -> Exit {
    let mut sources = Sources::new();
    let mut found = Diagnostics::new();
    for file in &args.files {
        found.extend(check_file(file, &mut sources));
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

/// Everything that is wrong with a file and with what it names.
fn check_file(path: &Path, sources: &mut Sources) -> Diagnostics {
    match kind(path) {
        Ok(FileKind::Shader) => shader::load(&DiskFiles, sources, &name(path), None).diagnostics,
        Ok(FileKind::Scene) => check_scene(path, sources),
        Ok(FileKind::Graph) => {
            let loaded = program::load(&DiskFiles, sources, &name(path), None);
            let mut found = loaded.diagnostics;
            if let Some(program) = &loaded.program {
                found.extend(check::check(program));
            }
            found
        }
        Err(error) => error.into(),
    }
}

/// The scene, its files and its graph, and the plan for just this scene.
fn check_scene(path: &Path, sources: &mut Sources) -> Diagnostics {
    let job = Job { source: path.to_owned(), ..Job::default() };
    let loaded = load(&DiskFiles, sources, &job, &mut Cache::default());
    let mut found = loaded.diagnostics;
    if let Some(content) = &loaded.content {
        found.extend(check::check(&content.program));
        let stand_in = check::stand_in(&content.program);
        let request = content.request(stand_in.features, stand_in.limits, &BTreeMap::new());
        match plan::instantiate(&content.program, &request) {
            Ok(plan) => found.extend(plan.warnings),
            // A warning of the variants that is an error here is told as the error.
            Err(errors) => found.extend(errors),
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
