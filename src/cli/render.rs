//! `meniscus render`: one picture, or a numbered sequence.

use std::io::IsTerminal as _;
use std::path::PathBuf;

use indicatif::{ProgressBar, ProgressStyle};

use super::args::RenderArgs;
use super::dump::{self, Dump};
use super::output::Output;
use super::report::{Exit, report, say};
use super::session::{Opening, job, moment, numbered};
use super::table;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};
use crate::files::DiskFiles;
use crate::host::picture::{self, PictureKind};
use crate::host::{Cache, Moment, Session, load};

pub fn run(args: &RenderArgs) -> Exit {
    let mut sources = Sources::new();
    match render(args, &mut sources) {
        Ok(notes) => report(&notes, &sources),
        Err(found) => report(&found, &sources),
    }
}

/// Everything but saying what was found.
fn render(args: &RenderArgs, sources: &mut Sources) -> Result<Diagnostics, Diagnostics> {
    let kind = picture_kind(&args.output)?;
    let dumps = dump::parse(&args.dump)?;
    let pictures = pictures(args)?;
    // Places are made before any work, so that a folder that is not there is told at once.
    let outputs: Result<Vec<Output>, _> = pictures.iter().map(|(path, _)| Output::reserve(path)).collect();
    let outputs = outputs?;
    let dumps = dump::reserve(dumps)?;
    let opening = Opening::begin(args.scene.backend.as_deref());
    let mut job = job(&args.scene);
    job.transparent = args.transparent;
    job.roots = dumps.iter().map(|d| d.path.clone()).collect();
    let loaded = load(&DiskFiles, sources, &job, &mut Cache::default());
    let mut notes = loaded.diagnostics;
    let Some(content) = loaded.content else { return Err(notes) };
    let mut session = Session::new(opening.wait().map_err(|e| with(&notes, e.into()))?);
    let built = session.build(content).map_err(|e| with(&notes, e))?;
    notes.extend(built.diagnostics);
    let drawn = draw(args, kind, &mut session, pictures.into_iter().map(|(_, at)| at).zip(outputs).collect(), dumps);
    match drawn {
        Ok(found) => {
            notes.extend(found);
            Ok(notes)
        }
        Err(found) => Err(with(&notes, found)),
    }
}

/// What was found before stays before what ended the work.
fn with(before: &Diagnostics, found: Diagnostics) -> Diagnostics {
    let mut all = before.clone();
    all.extend(found);
    all
}

fn picture_kind(path: &std::path::Path) -> Result<PictureKind, Diagnostic> {
    PictureKind::of(path).ok_or_else(|| {
        let message = format!("`{}`: pictures are written as .png or .exr", path.display());
        Diagnostic::error(Code::USAGE, message)
    })
}

/// The files to write and the moment that each shows.
fn pictures(args: &RenderArgs) -> Result<Vec<(PathBuf, Moment)>, Diagnostic> {
    let Some(frames) = &args.frames else { return Ok(vec![(args.output.clone(), moment(args.when))]) };
    let count = frames.0.end() - frames.0.start();
    if count >= MOST_FRAMES {
        return Err(Diagnostic::error(Code::USAGE, format!("a sequence has at most {MOST_FRAMES} frames")));
    }
    Ok(frames.0.clone().map(|frame| (numbered(&args.output, frame), Moment::at_frame(frame))).collect())
}

const MOST_FRAMES: u64 = 10_000;

fn draw(
    args: &RenderArgs,
    kind: PictureKind,
    session: &mut Session,
    pictures: Vec<(Moment, Output)>,
    dumps: Vec<Dump>,
) -> Result<Diagnostics, Diagnostics> {
    let mut notes = Diagnostics::new();
    let bar = progress(pictures.len());
    for (at, output) in pictures {
        let drawn = session.draw(at, kind == PictureKind::Png)?;
        notes.extend(drawn.diagnostics);
        output.write(&encode(session, kind, args.transparent)?)?;
        if args.timings {
            say(&table::passes(&drawn.reports));
        }
        if let Some(bar) = &bar {
            bar.inc(1);
        }
    }
    for dump in dumps {
        notes.extend(dump.write(session)?);
    }
    Ok(notes)
}

/// The picture that was drawn last, as a file's bytes.
pub fn encode(session: &mut Session, kind: PictureKind, transparent: bool) -> Result<Vec<u8>, Diagnostic> {
    let encoded = match kind {
        PictureKind::Png => {
            let data = session.presented()?;
            if data.format != crate::format::TextureFormat::Rgba16Float {
                let message = "the presenting graph's output is not `Rgba16Float`";
                return Err(Diagnostic::error(Code::FORMAT, message));
            }
            picture::presented_png([data.width, data.height], &data.bytes, transparent)
        }
        PictureKind::Exr => picture::exr(&session.light()?),
    };
    encoded.map_err(|why| Diagnostic::error(Code::OUTPUT, format!("the picture cannot be encoded: {why}")))
}

/// For long work on a terminal.
fn progress(pictures: usize) -> Option<ProgressBar> {
    if pictures < 2 || !std::io::stderr().is_terminal() {
        return None;
    }
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} pictures, {eta} left").ok()?;
    Some(ProgressBar::new(pictures as u64).with_style(style))
}
