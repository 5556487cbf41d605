//! `meniscus render`: one picture, or a numbered sequence.

use std::io::IsTerminal as _;
use std::path::PathBuf;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use super::args::RenderArgs;
use super::dump;
use super::output::Output;
use super::report::{Exit, report, say};
use super::session::{Opening, job, numbered, when};
use super::table;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};
use crate::files::DiskFiles;
use crate::host::picture::PictureKind;
use crate::host::{Cache, Player, Session, When, load};

pub fn run(args: &RenderArgs) -> Exit {
    let mut sources = Sources::new();
    match render(args, &mut sources) {
        Ok(notes) => report(&notes, &sources),
        Err(found) => report(&found, &sources),
    }
}

/// Everything but saying what was found.
fn render(args: &RenderArgs, sources: &mut Sources) -> Result<Diagnostics, Diagnostics> {
    let mut clock = Clock::default();
    let kind = picture_kind(&args.output)?;
    let dumps = dump::parse(&args.dump)?;
    let pictures = pictures(args)?;
    // The place is made before any work, so that a folder that is not there is told at once.
    let first = pictures.first().map(|(path, _)| Output::reserve(path)).transpose()?;
    let dumps = dump::reserve(dumps)?;
    let opening = Opening::begin(args.scene.backend.as_deref());
    let mut job = job(&args.scene);
    job.transparent = args.transparent;
    job.when = pictures.first().map_or(When::Start, |(_, when)| *when);
    job.plays = pictures.len() > 1;
    job.roots = dumps.iter().map(|d| d.path.clone()).collect();
    let loaded = load(&DiskFiles, sources, &job, &mut Cache::default());
    let mut notes = loaded.diagnostics;
    let Some(content) = loaded.content else { return Err(notes) };
    clock.lap("loading");
    let gpu = opening.wait().map_err(|e| with(&notes, e.into()))?;
    clock.lap("waiting for the device");
    let mut session = Session::new(gpu);
    let built = session.build(content).map_err(|e| with(&notes, e))?;
    notes.extend(built.diagnostics);
    clock.lap("building");
    drop(first);
    let drawn = draw(args, kind, &mut session, &pictures, &mut clock).map_err(|e| with(&notes, e))?;
    notes.extend(drawn);
    for dump in dumps {
        let written = dump.write(&mut session).map_err(|e| with(&notes, e.into()))?;
        notes.extend(written);
    }
    if args.timings {
        say(&clock.line());
    }
    Ok(notes)
}

/// Where the time of the whole run goes.
struct Clock {
    last: Instant,
    /// Milliseconds.
    laps: Vec<(&'static str, f64)>,
}

impl Default for Clock {
    fn default() -> Self {
        Self { last: Instant::now(), laps: Vec::new() }
    }
}

impl Clock {
    /// Ends a phase; the same one may come again.
    fn lap(&mut self, phase: &'static str) {
        let ms = self.last.elapsed().as_secs_f64() * 1e3;
        self.last = Instant::now();
        match self.laps.iter_mut().find(|(known, _)| *known == phase) {
            Some((_, sum)) => *sum += ms,
            None => self.laps.push((phase, ms)),
        }
    }

    fn line(&self) -> String {
        let laps: Vec<String> = self.laps.iter().map(|(phase, ms)| format!("{phase} {ms:.1}")).collect();
        let all: f64 = self.laps.iter().map(|(_, ms)| ms).sum();
        format!("{all:.1} ms in all: {}", laps.join(", "))
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

/// The files to write and when each is.
fn pictures(args: &RenderArgs) -> Result<Vec<(PathBuf, When)>, Diagnostic> {
    let Some(frames) = &args.frames else { return Ok(vec![(args.output.clone(), when(args.when))]) };
    let count = frames.0.end() - frames.0.start();
    if count >= MOST_FRAMES {
        return Err(Diagnostic::error(Code::USAGE, format!("a sequence has at most {MOST_FRAMES} frames")));
    }
    Ok(frames.0.clone().map(|frame| (numbered(&args.output, frame), When::Frame(frame))).collect())
}

const MOST_FRAMES: u64 = 10_000;

fn draw(
    args: &RenderArgs,
    kind: PictureKind,
    session: &mut Session,
    pictures: &[(PathBuf, When)],
    clock: &mut Clock,
) -> Result<Diagnostics, Diagnostics> {
    let mut notes = Diagnostics::new();
    let bar = progress(pictures.len());
    let tracks = session.tracks().to_vec();
    let Some(mut player) = pictures.first().map(|(_, first)| Player::new(&tracks, *first, DiskFiles)) else {
        return Ok(notes);
    };
    for (path, when) in pictures {
        let output = Output::reserve(path)?;
        if !session.steps_see_files() {
            session.turn_to(*when, &mut player, &mut notes).map_err(|e| with(&notes, e))?;
            clock.lap("a frame's files");
        }
        let drawn = session.draw_at(*when, &mut player, kind == PictureKind::Png).map_err(|e| with(&notes, e))?;
        notes.extend(drawn.diagnostics);
        clock.lap("drawing");
        output.write(&session.encoded(kind, args.transparent)?)?;
        clock.lap("writing");
        if args.timings {
            say(&table::passes(&drawn.reports));
        }
        if let Some(bar) = &bar {
            bar.inc(1);
        }
    }
    Ok(notes)
}

/// For long work on a terminal.
fn progress(pictures: usize) -> Option<ProgressBar> {
    if pictures < 2 || !std::io::stderr().is_terminal() {
        return None;
    }
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} pictures, {eta} left").ok()?;
    Some(ProgressBar::new(pictures as u64).with_style(style))
}
