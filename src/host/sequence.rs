//! Playing numbered files: each frame's particles, decoded ahead on another thread.
//!
//! A frame whose file is missing or damaged shows the nearest one before it, and is told once. No
//! more frames than are read ahead are held in memory.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io;
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use super::assets::{Asset, Particles, decode_particles};
use super::draw::Moment;
use super::inputs::Input;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::files::Files;
use crate::plan::model::{Plan, Steps, Unit};
use crate::scene::particles::Taken;
use crate::scene::sequence::Pattern;

/// Frames that are decoded before they are asked for.
const AHEAD: u64 = 2;

/// A sequence of files that feeds an input.
#[derive(Clone, Debug)]
pub struct Track {
    /// The input.
    pub input: String,
    pub pattern: Pattern,
    pub frames: RangeInclusive<u64>,
    /// Frames a second.
    pub rate: f64,
    pub taken: Taken,
    /// Metres, of all frames.
    pub radius_m: f64,
    /// In place of each frame's own bounds.
    pub bounds: Option<[[f32; 3]; 2]>,
}

/// When a picture is, as somebody says it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum When {
    #[default]
    Start,
    /// A frame; of a sequence, the file's number.
    Frame(u64),
    /// Seconds since the start.
    Time(f64),
}

impl When {
    /// The frame of a sequence that is shown then.
    pub fn frame(self, frames: &RangeInclusive<u64>, rate: f64) -> u64 {
        let frame = match self {
            When::Start => *frames.start(),
            When::Frame(frame) => frame,
            When::Time(time_s) => frames.start().saturating_add((time_s * rate + 1e-6).floor() as u64),
        };
        frame.clamp(*frames.start(), *frames.end())
    }

    /// The moment, in a scene whose first sequence is `track`.
    pub fn moment(self, track: Option<&Track>) -> Moment {
        match (self, track) {
            (When::Start, None) => Moment::default(),
            (When::Frame(frame), None) => Moment::at_frame(frame),
            (When::Time(time_s), None) => Moment::at_time(time_s),
            (when, Some(Track { frames, rate, .. })) => {
                let first = *frames.start();
                let frame = match when {
                    When::Start => first,
                    When::Frame(frame) => frame,
                    When::Time(time_s) => return Moment { frame: when.frame(&(first..=u64::MAX), *rate), time_s },
                };
                Moment { frame, time_s: frame.saturating_sub(first) as f64 / rate }
            }
        }
    }
}

/// Steps that lead up to a picture by itself all see the particles of the picture's frame, which is told.
pub fn not_in_steps(plan: &Plan, tracks: &[Track]) -> Diagnostics {
    let mut found = Diagnostics::new();
    for track in tracks.iter().filter(|track| track.frames.start() < track.frames.end()) {
        let sees = |steps: &&Steps| {
            let stepped = |unit: &&Unit| unit.passes.iter().any(|pass| steps.passes.contains(pass));
            plan.units.iter().filter(stepped).any(|unit| unit.causes.inputs.contains(&track.input))
        };
        if let Some(steps) = plan.steps.iter().find(sees) {
            let (input, path) = (&track.input, &steps.path);
            let message = format!("all of `{path}` sees the particles `{input}` of the picture's frame");
            let hint =
                "steps do not see each frame's file yet: what they remember is as if this file had always been there";
            found.push(Diagnostic::warning(Code::ASSET_NOTE, message).hint(hint));
        }
    }
    found
}

/// What is shown at a frame, and what a person should know of it.
struct Answer {
    particles: Option<Arc<Particles>>,
    told: Diagnostics,
}

struct Request {
    track: usize,
    frame: u64,
}

/// Decodes frames ahead of being asked, for as long as it lives.
#[derive(Debug)]
pub struct Player {
    tracks: Vec<Playing>,
    requests: Sender<Request>,
    answers: Receiver<(Request, Answer)>,
}

struct Playing {
    track: Track,
    /// The frame at hand and those ahead of it.
    asked: BTreeSet<u64>,
    /// Those of them that were answered.
    read: BTreeMap<u64, Answer>,
    shown: Option<u64>,
}

impl fmt::Debug for Playing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Playing").field("track", &self.track).field("asked", &self.asked).finish_non_exhaustive()
    }
}

impl Player {
    /// Plays tracks, of which the frames in `shown` are there already.
    pub fn new(tracks: &[Track], shown: When, files: impl Files + Send + 'static) -> Self {
        let (requests, inbox) = channel::<Request>();
        let (outbox, answers) = channel();
        let known = tracks.to_vec();
        // Ends when the player is dropped, since nobody asks or listens any more.
        thread::spawn(move || {
            let mut last = vec![None; known.len()];
            for request in inbox {
                let answer = answer(&files, &known[request.track], request.frame, &mut last[request.track]);
                if outbox.send((request, answer)).is_err() {
                    return;
                }
            }
        });
        let playing = |track: &Track| Playing {
            track: track.clone(),
            asked: BTreeSet::new(),
            read: BTreeMap::new(),
            shown: Some(shown.frame(&track.frames, track.rate)),
        };
        Self { tracks: tracks.iter().map(playing).collect(), requests, answers }
    }

    /// The inputs that a frame changes.
    pub fn inputs(&mut self, when: When, diagnostics: &mut Diagnostics) -> BTreeMap<String, Input> {
        let mut inputs = BTreeMap::new();
        for at in 0..self.tracks.len() {
            let Track { frames, rate, .. } = &self.tracks[at].track;
            let frame = when.frame(frames, *rate);
            self.ask_around(at, frame);
            if self.tracks[at].shown != Some(frame)
                && let Some(particles) = self.wait(at, frame, diagnostics)
            {
                self.tracks[at].shown = Some(frame);
                inputs.insert(self.tracks[at].track.input.clone(), Input::Particles(particles));
            }
        }
        inputs
    }

    /// Asks for a frame, unless it is shown, and for those that come next; lets go of all others.
    fn ask_around(&mut self, at: usize, frame: u64) {
        let playing = &mut self.tracks[at];
        let wanted = frame..=frame.saturating_add(AHEAD).min(*playing.track.frames.end());
        playing.read.retain(|frame, _| wanted.contains(frame));
        playing.asked.retain(|frame| wanted.contains(frame));
        for frame in wanted.filter(|frame| playing.shown != Some(*frame)) {
            if playing.asked.insert(frame) {
                // Without the other thread nothing is answered, which is told where it is waited for.
                _ = self.requests.send(Request { track: at, frame });
            }
        }
    }

    fn wait(&mut self, at: usize, frame: u64, diagnostics: &mut Diagnostics) -> Option<Arc<Particles>> {
        loop {
            if let Some(answer) = self.tracks[at].read.get_mut(&frame) {
                diagnostics.extend(std::mem::take(&mut answer.told));
                return answer.particles.clone();
            }
            let Ok((request, answer)) = self.answers.recv() else {
                diagnostics.push(Diagnostic::error(Code::ASSET, format!("frame {frame}: the reader failed")));
                return None;
            };
            let playing = &mut self.tracks[request.track];
            if playing.asked.contains(&request.frame) {
                playing.read.insert(request.frame, answer);
            }
        }
    }
}

/// What was decoded last, and of which frame.
type Last = Option<(u64, Arc<Particles>)>;

/// The particles of a frame, or of the nearest one before it that is whole.
fn answer(files: &dyn Files, track: &Track, frame: u64, last: &mut Last) -> Answer {
    let mut told = Diagnostics::new();
    let mut why = None;
    for at in (*track.frames.start()..=frame).rev() {
        let known = last.as_ref().filter(|(known, _)| *known == at).map(|(_, particles)| Arc::clone(particles));
        let particles = match known {
            Some(particles) => Ok(particles),
            None => decode(files, track, at, &mut told),
        };
        match particles {
            Ok(particles) => {
                if let Some(why) = why {
                    told.push(held(why, frame, at));
                }
                *last = Some((at, Arc::clone(&particles)));
                return Answer { particles: Some(particles), told };
            }
            Err(wrong) => _ = why.get_or_insert(wrong),
        }
    }
    why.into_iter().for_each(|why| told.push(why));
    Answer { particles: None, told }
}

/// A fault of a frame that does not end the sequence, since another is shown in its place.
pub(super) fn held(why: Diagnostic, frame: u64, shown: u64) -> Diagnostic {
    let message = format!("frame {frame}: {}: frame {shown} is shown in its place", why.message);
    let warning = Diagnostic::warning(why.id, message);
    why.hints.iter().fold(warning, Diagnostic::hint)
}

fn decode(files: &dyn Files, track: &Track, frame: u64, told: &mut Diagnostics) -> Result<Arc<Particles>, Diagnostic> {
    let path = track.pattern.path(frame);
    let bytes = files.read(&path).map_err(|error| unreadable(&path, &error))?;
    let (asset, found) = decode_particles(&path, &bytes, &track.taken, false)?;
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
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::files::MemoryFiles;
    use crate::scene::placement::{Placement, Up};

    fn track(rate: f64) -> Track {
        let pattern = Pattern::of(Path::new("f/p_##.csv")).expect("a pattern");
        Track {
            input: "particles".into(),
            pattern,
            frames: 3..=9,
            rate,
            taken: Taken::default(),
            radius_m: 0.5,
            bounds: None,
        }
    }

    /// Frames 3 to 9 without 5 and 6; 8 is damaged. Frame n has n particles.
    fn files() -> MemoryFiles {
        let csv = |n: u64| format!("x,y,z\n{}", (0..n).map(|i| format!("{i},{n},0\n")).collect::<String>());
        let whole = [3_u64, 4, 7, 9].into_iter();
        let files = whole.fold(MemoryFiles::default(), |files, n| files.with(format!("f/p_{n:02}.csv"), csv(n)));
        files.with("f/p_08.csv", "x,y,z\n1,2\n")
    }

    fn shown(player: &mut Player, when: When) -> (Option<usize>, Vec<String>) {
        let mut found = Diagnostics::new();
        let inputs = player.inputs(when, &mut found);
        let count = inputs.get("particles").map(|input| match input {
            Input::Particles(particles) => particles.set.count,
            other => panic!("{other:?}"),
        });
        (count, found.iter().map(|d| d.message.clone()).collect())
    }

    #[test]
    fn what_is_missing_or_damaged_is_told_and_the_one_before_stays() {
        let mut player = Player::new(&[track(25.0)], When::Frame(3), files());
        let mut play = |frame| shown(&mut player, When::Frame(frame));
        assert_eq!(play(3), (None, vec![]), "this one is there already");
        assert_eq!(play(4), (Some(4), vec![]));
        let missing = "frame 5: there is no file `f/p_05.csv`: frame 4 is shown in its place";
        assert_eq!(play(5), (Some(4), vec![missing.to_owned()]));
        assert_eq!(play(7), (Some(7), vec![]));
        let (count, told) = play(8);
        assert_eq!(count, Some(7));
        assert!(told[0].starts_with("frame 8: `f/p_08.csv`: line 2, column 1: ") && told.len() == 1, "{told:?}");
        assert_eq!(play(9), (Some(9), vec![]));
        assert_eq!(play(99), (None, vec![]), "the last one stays, and is there already");
        assert_eq!(play(4), (Some(4), vec![]), "back again");
    }

    #[test]
    fn each_frame_is_taken_as_the_scene_says() {
        let taken = Taken { placement: Placement::of_file(Up::Z, 2.0), ..Taken::default() };
        let mut player = Player::new(&[Track { taken, ..track(25.0) }], When::Start, files());
        let inputs = player.inputs(When::Frame(4), &mut Diagnostics::new());
        let Some(Input::Particles(particles)) = inputs.get("particles") else { panic!("{inputs:?}") };
        assert_eq!((particles.min, particles.max), ([0.0, 0.0, -8.0], [6.0, 0.0, -8.0]));
    }

    #[test]
    fn a_jump_shows_what_playing_from_the_start_would() {
        let mut player = Player::new(&[track(25.0)], When::Start, files());
        let missing = "frame 6: there is no file `f/p_06.csv`: frame 4 is shown in its place";
        assert_eq!(shown(&mut player, When::Frame(6)), (Some(4), vec![missing.to_owned()]));
    }

    #[test]
    fn no_more_is_held_than_is_read_ahead() {
        let mut player = Player::new(&[track(25.0)], When::Start, files());
        for frame in [4, 5, 6, 7, 9, 3, 8] {
            shown(&mut player, When::Frame(frame));
            assert!(player.tracks[0].read.len() <= 1 + AHEAD as usize, "{frame}");
            assert!(player.tracks[0].asked.len() <= 1 + AHEAD as usize, "{frame}");
        }
    }

    /// Files that take a while to read.
    struct Slow(MemoryFiles, Duration);

    impl Files for Slow {
        fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
            thread::sleep(self.1);
            self.0.read(path)
        }

        fn exists(&self, path: &Path) -> bool {
            self.0.exists(path)
        }
    }

    /// Plays at a frame each 50 ms; gives the longest wait for a frame once it is warm.
    fn longest_wait(reading: Duration) -> Duration {
        let csv = |n: u64| format!("x,y,z\n{}", (0..n).map(|i| format!("{i},{n},0\n")).collect::<String>());
        let files = (0..20).fold(MemoryFiles::default(), |files, n| files.with(format!("f/p_{n:02}.csv"), csv(n + 1)));
        let track = Track { frames: 0..=19, ..track(20.0) };
        let mut player = Player::new(&[track], When::Frame(0), Slow(files, reading));
        let frame = Duration::from_millis(50);
        let began = Instant::now();
        let mut longest = Duration::ZERO;
        for n in 0..20_u32 {
            thread::sleep((frame * n).saturating_sub(began.elapsed()));
            let asked = Instant::now();
            shown(&mut player, When::Frame(n.into()));
            if n > AHEAD as u32 {
                longest = longest.max(asked.elapsed());
            }
        }
        longest
    }

    #[test]
    fn a_sequence_plays_without_a_stall() {
        // A file that takes 0.6 of a frame is there when it is asked for, one that takes three frames is not.
        let quick = (0..3).map(|_| longest_wait(Duration::from_millis(30))).min();
        assert!(quick.is_some_and(|wait| wait < Duration::from_millis(50)), "{quick:?}");
        let slow = longest_wait(Duration::from_millis(150));
        assert!(slow > Duration::from_millis(50), "{slow:?}");
    }

    #[test]
    fn time_goes_at_the_rate_from_the_first_frame() {
        let track = track(10.0);
        let at = |when: When| (when.frame(&track.frames, track.rate), when.moment(Some(&track)));
        let moment = |frame, time_s| Moment { frame, time_s };
        assert_eq!(at(When::Start), (3, moment(3, 0.0)));
        assert_eq!(at(When::Frame(5)), (5, moment(5, 0.2)));
        assert_eq!(at(When::Time(0.2)), (5, moment(5, 0.2)));
        assert_eq!(at(When::Time(0.19)), (4, moment(4, 0.19)));
        assert_eq!(at(When::Time(100.0)).0, 9, "the last one stays");
        assert_eq!(When::Frame(30).moment(None), Moment::at_frame(30));
    }
}
