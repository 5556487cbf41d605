//! Playing numbered files: each frame's particles, decoded ahead on another thread.
//!
//! A frame whose file is missing or damaged shows the nearest one before it, and is told once. No
//! more frames are held in memory than the one that is shown and those that are read ahead: what nobody wants any
//! more is neither decoded nor kept.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io;
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};

use twox_hash::XxHash3_128;

use super::assets::{Asset, Particles, decode_particles};
use super::frames::numbered_files;
use super::inputs::Input;
use super::sequence::{Track, When, held};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::files::Files;

/// Frames that are decoded before they are asked for.
const AHEAD: u64 = 2;
/// The names in a folder are taken to stay for so long, where many frames are missing.
const NAMES_STAY: Duration = Duration::from_secs(1);

/// Decodes frames ahead of being asked, for as long as it lives.
#[derive(Debug)]
pub struct Player {
    tracks: Vec<Playing>,
    desk: Arc<Desk>,
}

#[derive(Debug)]
struct Playing {
    track: Track,
    /// The frame that is shown, or none of a sequence that begins later.
    shown: Option<u64>,
    /// Frames that it does not have were told of.
    is_told: bool,
}

/// A frame of one of the tracks.
type Wanted = (usize, u64);

/// What is shown at a frame, and what a person should know of it.
struct Answer {
    particles: Option<Arc<Particles>>,
    told: Diagnostics,
}

/// Where the player says what it wants, and the reader lays it down.
#[derive(Debug, Default)]
struct Desk {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    /// The frames at hand, then those ahead of them.
    wanted: Vec<Wanted>,
    /// Those of them that were read.
    answers: BTreeMap<Wanted, Answer>,
    /// Nobody wants any more, or nobody reads.
    is_over: bool,
}

impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("State").field("wanted", &self.wanted).finish_non_exhaustive()
    }
}

impl Desk {
    fn state(&self) -> MutexGuard<'_, State> {
        // No step of a change leaves a state that others could not go on with.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets go of all others.
    fn want(&self, wanted: Vec<Wanted>) {
        let mut state = self.state();
        state.answers.retain(|key, _| wanted.contains(key));
        state.wanted = wanted;
        self.changed.notify_all();
    }

    /// Waits for a frame. What is told of it is told once.
    fn wait(&self, wanted: Wanted) -> Option<(Option<Arc<Particles>>, Diagnostics)> {
        let mut state = self.state();
        loop {
            if let Some(answer) = state.answers.get_mut(&wanted) {
                return Some((answer.particles.clone(), std::mem::take(&mut answer.told)));
            }
            if state.is_over {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Waits until something is to be read; none when all is over.
    fn next(&self) -> Option<Wanted> {
        let mut state = self.state();
        loop {
            if state.is_over {
                return None;
            }
            if let Some(next) = state.wanted.iter().find(|wanted| !state.answers.contains_key(wanted)) {
                return Some(*next);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Lays down a frame, unless it is not wanted any more.
    fn answer(&self, wanted: Wanted, answer: Answer) {
        let mut state = self.state();
        if state.wanted.contains(&wanted) {
            state.answers.insert(wanted, answer);
            self.changed.notify_all();
        }
    }

    fn end(&self) {
        self.state().is_over = true;
        self.changed.notify_all();
    }
}

impl Player {
    /// Plays tracks, of which what shows at `shown` is there already, and told of.
    pub fn new(tracks: &[Track], shown: When, files: impl Files + Send + 'static) -> Self {
        let desk = Arc::new(Desk::default());
        let mut reader = Reader {
            files,
            known: tracks.iter().map(|track| (track.clone(), Known::default())).collect(),
            desk: Arc::clone(&desk),
        };
        thread::spawn(move || reader.read());
        let playing = |track: &Track| Playing {
            track: track.clone(),
            shown: track.frames.frame(shown),
            is_told: track.frames.outside(shown).is_some(),
        };
        Self { tracks: tracks.iter().map(playing).collect(), desk }
    }

    /// The inputs that a frame changes.
    pub fn inputs(&mut self, when: When, diagnostics: &mut Diagnostics) -> BTreeMap<String, Input> {
        self.desk.want(self.wanted(when));
        let mut inputs = BTreeMap::new();
        for (at, playing) in self.tracks.iter_mut().enumerate() {
            playing.tell(when, diagnostics);
            let frame = playing.track.frames.frame(when);
            if playing.shown == frame {
                continue;
            }
            let particles = match frame {
                None => playing.track.none.clone(),
                Some(frame) => waited(&self.desk, (at, frame), diagnostics),
            };
            if let Some(particles) = particles {
                playing.shown = frame;
                inputs.insert(playing.track.input.clone(), Input::Particles(particles));
            }
        }
        inputs
    }

    /// The frames at hand that are not shown yet, then those that come next.
    fn wanted(&self, when: When) -> Vec<Wanted> {
        let tracks = || self.tracks.iter().enumerate();
        let now = tracks().filter_map(|(at, playing)| Some((at, playing.track.frames.frame(when)?)));
        let next = tracks().flat_map(|(at, playing)| playing.track.frames.next(when, AHEAD).map(move |n| (at, n)));
        let is_shown = |(at, frame): &Wanted| self.tracks[*at].shown == Some(*frame);
        now.chain(next).filter(|wanted| !is_shown(wanted)).collect()
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        self.desk.end();
    }
}

impl Playing {
    /// Once, that a frame is none of the sequence's.
    fn tell(&mut self, when: When, diagnostics: &mut Diagnostics) {
        if !self.is_told
            && let Some(outside) = self.track.frames.outside(when)
        {
            self.is_told = true;
            diagnostics.push(outside);
        }
    }
}

fn waited(desk: &Desk, wanted: Wanted, diagnostics: &mut Diagnostics) -> Option<Arc<Particles>> {
    let Some((particles, told)) = desk.wait(wanted) else {
        diagnostics.push(Diagnostic::error(Code::ASSET, format!("frame {}: the reader failed", wanted.1)));
        return None;
    };
    diagnostics.extend(told);
    particles
}

/// The other thread.
struct Reader<F: Files> {
    files: F,
    known: Vec<(Track, Known)>,
    desk: Arc<Desk>,
}

impl<F: Files> Reader<F> {
    fn read(&mut self) {
        while let Some((at, frame)) = self.desk.next() {
            let Some((track, known)) = self.known.get_mut(at) else { return };
            let answer = known.answer(&self.files, track, frame);
            self.desk.answer((at, frame), answer);
        }
    }
}

impl<F: Files> Drop for Reader<F> {
    /// Also where a reader panics: nobody waits for it then.
    fn drop(&mut self) {
        self.desk.end();
    }
}

/// What is known of a track's files.
#[derive(Default)]
struct Known {
    /// What was decoded last, for as long as somebody else holds it.
    last: Option<(u64, Weak<Particles>)>,
    /// Damaged files, with the hash of their bytes.
    damaged: BTreeMap<u64, (u128, Diagnostic)>,
    /// The frames whose files are there, as they were when they were last looked for.
    there: Option<(Instant, BTreeSet<u64>)>,
}

impl Known {
    /// The particles of a frame, or of the nearest one before it that is whole.
    fn answer(&mut self, files: &dyn Files, track: &Track, frame: u64) -> Answer {
        let mut told = Diagnostics::new();
        let mut why = None;
        let mut next = Some(frame);
        while let Some(at) = next {
            match self.particles(files, track, at, &mut told) {
                Ok(particles) => {
                    why.into_iter().for_each(|why| told.push(held(why, frame, at)));
                    self.last = Some((at, Arc::downgrade(&particles)));
                    return Answer { particles: Some(particles), told };
                }
                Err(wrong) => _ = why.get_or_insert(wrong),
            }
            next = self.whole_before(files, track, at);
        }
        why.into_iter().for_each(|why| told.push(why));
        Answer { particles: None, told }
    }

    /// The nearest frame before one whose file is there, and was not damaged when it was last read.
    fn whole_before(&mut self, files: &dyn Files, track: &Track, frame: u64) -> Option<u64> {
        let there = match self.there.take().filter(|(since, _)| since.elapsed() < NAMES_STAY) {
            Some(there) => there,
            None => (Instant::now(), numbered_files(files, &track.frames.pattern)),
        };
        let (_, numbers) = self.there.insert(there);
        let before = numbers.range(track.frames.first()..frame).rev();
        before.copied().find(|number| !self.damaged.contains_key(number))
    }

    fn particles(
        &mut self,
        files: &dyn Files,
        track: &Track,
        frame: u64,
        told: &mut Diagnostics,
    ) -> Result<Arc<Particles>, Diagnostic> {
        let last = self.last.as_ref().filter(|(known, _)| *known == frame);
        if let Some(particles) = last.and_then(|(_, particles)| particles.upgrade()) {
            return Ok(particles);
        }
        let path = track.frames.pattern.path(frame);
        let bytes = files.read(&path).map_err(|error| unreadable(&path, &error))?;
        if let Some((hash, wrong)) = self.damaged.get(&frame)
            && *hash == XxHash3_128::oneshot(&bytes)
        {
            return Err(wrong.clone());
        }
        let decoded = decode(&path, &bytes, track, told);
        match &decoded {
            Ok(_) => _ = self.damaged.remove(&frame),
            Err(wrong) => _ = self.damaged.insert(frame, (XxHash3_128::oneshot(&bytes), wrong.clone())),
        }
        decoded
    }
}

fn decode(path: &Path, bytes: &[u8], track: &Track, told: &mut Diagnostics) -> Result<Arc<Particles>, Diagnostic> {
    let (asset, found) = decode_particles(path, bytes, &track.taken, false)?;
    let Asset::Particles(set, _) = asset else {
        return Err(Diagnostic::error(Code::ASSET, format!("`{}` holds no particles", path.display())));
    };
    // What is told of the first frame holds for most: of the others only what is lost.
    if set.dropped > 0 {
        told.extend(found);
    }
    Ok(Arc::new(Particles::new(set, track.radius_m, track.bounds)))
}

fn unreadable(path: &Path, error: &io::Error) -> Diagnostic {
    match error.kind() {
        io::ErrorKind::NotFound => {
            Diagnostic::error(Code::FILE_MISSING, format!("there is no file `{}`", path.display()))
        }
        _ => Diagnostic::error(Code::FILE_UNREADABLE, format!("`{}` cannot be read: {error}", path.display())),
    }
}

#[cfg(test)]
mod tests;
