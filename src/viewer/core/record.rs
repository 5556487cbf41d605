//! Pictures as files: one, or a numbered sequence.

use std::path::{Path, PathBuf};

use super::Core;
use crate::diagnostic::{Code, Diagnostic};
use crate::host::picture::{PictureKind, numbered};
use crate::output::Output;
use crate::viewer::state::short;

/// A sequence that is being written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recording {
    /// `{}`, or the place before the extension, gets the number.
    pub path: PathBuf,
    pub from: u64,
    pub to: u64,
    /// The frame that is written next.
    pub next: u64,
}

impl Recording {
    /// How much of it is done.
    pub fn part(&self) -> f32 {
        (self.next - self.from) as f32 / (self.to - self.from + 1) as f32
    }
}

impl Core {
    /// Writes the picture that is shown.
    pub(super) fn shoot(&mut self, path: &Path) {
        match self.write_picture(path) {
            Ok(()) => self.state.say(format!("{} was written", path.display())),
            Err(error) => self.state.say(error.message),
        }
    }

    fn write_picture(&mut self, path: &Path) -> Result<(), Diagnostic> {
        let Some(kind) = PictureKind::of(path) else {
            let message = format!("`{}`: pictures are written as .png or .exr", path.display());
            return Err(Diagnostic::error(Code::USAGE, message));
        };
        let output = Output::reserve(path)?;
        output.write(&self.session.encoded(kind, false)?)
    }

    pub(super) fn record(&mut self, recording: Recording) {
        if recording.to < recording.from {
            self.state.say("the first frame comes after the last");
            return;
        }
        self.state.clock.is_playing = false;
        let from_s = self.state.clock.time_of(recording.from);
        self.state.clock.seek(from_s);
        self.state.recording = Some(recording);
    }

    /// Writes the frame at hand if it is the next one, and goes on. Called while nothing is drawn
    /// and all steps of the frame are done.
    pub(super) fn record_frame(&mut self) -> bool {
        let Some(mut recording) = self.state.recording.take() else { return false };
        if self.state.clock.frame() != recording.next {
            // Somebody moved the time: the sequence decides.
            let next_s = self.state.clock.time_of(recording.next);
            self.state.clock.seek(next_s);
            if self.state.clock.frame() == recording.next {
                self.state.recording = Some(recording);
            } else {
                self.ended(&recording, &format!("the sequence ends at frame {}", self.state.clock.frame()));
            }
            return true;
        }
        if let Some(findings) = self.state.findings.as_ref().filter(|findings| findings.is_stale) {
            let why = findings.diagnostics.iter().next().map(|found| found.message.clone());
            self.ended(&recording, &why.unwrap_or_else(|| "the picture is of an earlier state".into()));
            return true;
        }
        let path = numbered(&recording.path, recording.next);
        if let Err(error) = self.write_picture(&path) {
            self.ended(&recording, &error.message);
            return true;
        }
        recording.next += 1;
        if recording.next > recording.to {
            let count = recording.to - recording.from + 1;
            self.state.say(format!("{count} pictures were written, the last is {}", short(&path)));
        } else {
            self.state.clock.step(1);
            self.state.recording = Some(recording);
        }
        true
    }

    fn ended(&mut self, recording: &Recording, why: &str) {
        let done = recording.next - recording.from;
        self.state.say(format!("recording ended after {done} pictures: {why}"));
    }
}

/// A name for a picture that is not taken yet.
pub fn free_name(stem: &str, end: &str) -> PathBuf {
    let name = |number: u32| PathBuf::from(format!("{stem}_{number:03}.{end}"));
    (1..10_000).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(10_000))
}
