//! Following files in this process as `watch` does: load, build aside, draw; a failure leaves the
//! picture as it was.

#![allow(dead_code, reason = "each test program uses a part of it")]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::engine::{Gpu, GpuOptions};
use meniscus::files::DiskFiles;
use meniscus::host::{Cache, Job, Moment, Session, load};
use meniscus::reload::Watch;

pub struct Follower {
    pub session: Session,
    job: Job,
    cache: Cache,
    watch: Watch,
}

/// Where the time of a reload went.
#[derive(Clone, Copy, Debug, Default)]
pub struct Times {
    pub noticing: Duration,
    pub checking: Duration,
    pub building: Duration,
    pub drawing: Duration,
}

/// What a change came to.
pub enum Outcome {
    Drawn { picture: Vec<u8>, times: Times, pipelines_built: usize },
    Refused(String),
}

impl Follower {
    pub fn new(source: PathBuf, size: [u32; 2]) -> Self {
        let gpu = Gpu::open(&GpuOptions::default()).unwrap();
        let job = Job { source, size: Some(size), ..Job::default() };
        Self { session: Session::new(gpu), job, cache: Cache::default(), watch: Watch::new().unwrap() }
    }

    /// Loads and draws now, and watches what was read.
    pub fn reload(&mut self) -> Outcome {
        let since = SystemTime::now();
        let began = Instant::now();
        let mut sources = Sources::new();
        let loaded = load(&DiskFiles, &mut sources, &self.job, &mut self.cache);
        self.watch.set(loaded.read.iter().map(PathBuf::as_path), since).unwrap();
        let checking = began.elapsed();
        let refused = |found: Diagnostics| Outcome::Refused(render_all(&found, &sources, Style::Plain));
        let Some(content) = loaded.content else { return refused(loaded.diagnostics) };
        let began = Instant::now();
        let built = match self.session.build(content) {
            Ok(built) => built,
            Err(found) => return refused(found),
        };
        let building = began.elapsed();
        let began = Instant::now();
        match self.session.draw(Moment::default(), true) {
            Ok(_) => {}
            Err(found) => return refused(found),
        }
        let picture = self.session.presented().unwrap().bytes;
        let times = Times { noticing: Duration::ZERO, checking, building, drawing: began.elapsed() };
        Outcome::Drawn { picture, times, pipelines_built: built.pipelines_built }
    }

    /// How long the frame at hand takes, drawn again with all its passes.
    pub fn redraw(&mut self) -> Duration {
        let began = Instant::now();
        self.session.run_all(true);
        self.session.draw(Moment::default(), true).unwrap();
        self.session.run_all(false);
        began.elapsed()
    }

    /// Waits for a change and follows it.
    pub fn follow(&mut self) -> Outcome {
        let change = self.watch.next(Duration::from_secs(60)).unwrap().expect("a change within a minute");
        match self.reload() {
            Outcome::Drawn { picture, times, pipelines_built } => {
                let times = Times { noticing: change.noticing, ..times };
                Outcome::Drawn { picture, times, pipelines_built }
            }
            refused => refused,
        }
    }

    /// What is shown now: the last good picture.
    pub fn shown(&mut self) -> Vec<u8> {
        self.session.presented().unwrap().bytes
    }

    /// A change must come that makes this picture.
    pub fn drawn(&mut self) -> Vec<u8> {
        match self.follow() {
            Outcome::Drawn { picture, .. } => picture,
            Outcome::Refused(said) => panic!("refused:\n{said}"),
        }
    }

    /// A change must come that is refused, and leaves what is shown; gives what was said.
    pub fn refused(&mut self) -> String {
        let before = self.shown();
        match self.follow() {
            Outcome::Refused(said) => {
                assert!(self.shown() == before, "the picture changed");
                said
            }
            Outcome::Drawn { .. } => panic!("a bad change was taken"),
        }
    }
}

/// The picture that a fresh start draws.
pub fn fresh(source: &Path, size: [u32; 2]) -> Vec<u8> {
    match Follower::new(source.to_owned(), size).reload() {
        Outcome::Drawn { picture, .. } => picture,
        Outcome::Refused(said) => panic!("refused:\n{said}"),
    }
}
