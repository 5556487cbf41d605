//! `meniscus new NAME`: a graph, a shader and a scene that run, with notes for newcomers.

use std::fmt::Write as _;
use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::path::PathBuf;

use super::args::NewArgs;
use super::report::{Exit, report, say};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};

const GRAPH: &str = include_str!("new/graph.ron");
const SHADER: &str = include_str!("new/discs.wgsl");
const SCENE: &str = include_str!("new/scene.ron");
const STATE_GRAPH: &str = include_str!("new/state/graph.ron");
const STATE_STEP: &str = include_str!("new/state/step.wgsl");
const STATE_SHOW: &str = include_str!("new/state/show.wgsl");
const STATE_SCENE: &str = include_str!("new/state/scene.ron");

pub fn run(args: &NewArgs) -> Exit {
    let files = if args.state { stateful(&args.name) } else { files(&args.name) };
    match write(&files) {
        Ok(()) => {
            for (path, _) in &files {
                say(&format!("made {}", path.display()));
            }
            let moment = if args.state { " --frame 120" } else { "" };
            say(&format!("see it with `meniscus render scenes/{0}.ron -o {0}.png{moment}`", args.name));
            Exit::Done
        }
        Err(found) => report(&found, &Sources::new()),
    }
}

fn files(name: &str) -> Vec<(PathBuf, String)> {
    let fill = |text: &str| text.replace("NAME", name);
    vec![
        (format!("graphs/{name}.ron").into(), fill(GRAPH)),
        (format!("shaders/{name}/discs.wgsl").into(), fill(SHADER)),
        (format!("scenes/{name}.ron").into(), fill(SCENE)),
        (format!("scenes/assets/{name}.csv").into(), particles()),
    ]
}

/// The same with state that steps change.
fn stateful(name: &str) -> Vec<(PathBuf, String)> {
    let fill = |text: &str| text.replace("NAME", name);
    vec![
        (format!("graphs/{name}.ron").into(), fill(STATE_GRAPH)),
        (format!("shaders/{name}/step.wgsl").into(), fill(STATE_STEP)),
        (format!("shaders/{name}/show.wgsl").into(), fill(STATE_SHOW)),
        (format!("scenes/{name}.ron").into(), fill(STATE_SCENE)),
    ]
}

/// A spiral of points, in metres.
fn particles() -> String {
    let mut text = String::from("x,y,z\n");
    for i in 0..200 {
        let turn = f64::from(i) * 0.3;
        let (height, radius) = (f64::from(i) * 0.005, 0.5 - f64::from(i) * 0.002);
        _ = writeln!(text, "{:.4},{height:.4},{:.4}", turn.cos() * radius, turn.sin() * radius);
    }
    text
}

/// All files, or none where one is there already.
fn write(files: &[(PathBuf, String)]) -> Result<(), Diagnostics> {
    let mut found = Diagnostics::new();
    for (path, _) in files.iter().filter(|(path, _)| path.exists()) {
        let message = format!("`{}` is there already, and nothing was written", path.display());
        found.push(Diagnostic::error(Code::OUTPUT, message).hint("choose another name"));
    }
    if !found.is_empty() {
        return Err(found);
    }
    for (path, text) in files {
        let made = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| {
            let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
            file.write_all(text.as_bytes())
        });
        made.map_err(|error| {
            Diagnostic::error(Code::OUTPUT, format!("`{}` cannot be written: {error}", path.display()))
        })?;
    }
    Ok(())
}
