//! What happens in the window, without a window: news from the worker, frames for the device,
//! and what a person asked for.

mod act;
mod count;
mod files;
mod frame;
mod look;
mod record;
mod rounds;

use std::time::{Duration, Instant};

use count::Counted;
use frame::{InFlight, Made};

use super::look::Look;
use super::state::{Findings, State};
use super::viewpoints;
use super::worker::{Wants, Worker};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};
use crate::engine::{Gpu, Screen, any_device_gone};
use crate::host::{Input, Job, Session, When};
use crate::plan::model::Plan;

pub use look::Hunt;
pub use record::{Recording, free_name};

/// A window that is being resized asks for another picture size after this rest.
const RESIZE_REST: Duration = Duration::from_millis(120);
/// A frame that takes longer is told.
const PATIENCE: Duration = Duration::from_secs(10);
/// How often an unfinished frame is looked after.
const POLL: Duration = Duration::from_millis(2);

/// What is asked of the event loop after a [`Core::tick`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tick {
    /// Something that is seen changed.
    pub repaint: bool,
    /// The next tick is due after so long, if nothing else happens.
    pub again: Option<Duration>,
    /// The device is gone and must be replaced.
    pub is_lost: bool,
}

#[derive(Debug)]
pub struct Core {
    session: Session,
    screen: Screen,
    worker: Worker,
    pub state: State,
    /// Texts of the content that is built.
    sources: Sources,
    wants: Wants,
    sent: Wants,
    /// What is opened once the size is known.
    opening: Option<Job>,
    /// When the wanted size changed last.
    resized: Option<Instant>,
    made: Option<Made>,
    /// The time for which steps once a frame ran: a frame that is drawn again runs none.
    stepped_s: Option<f64>,
    version: u64,
    in_flight: Option<InFlight>,
    /// When time was advanced last.
    advanced: Option<Instant>,
    /// The frame of sequences that the last round showed.
    answered: When,
    /// The last time whose frame of sequences was there.
    fed_s: f64,
    /// Steps at a rate see the files of sequences.
    is_led: bool,
    /// For their sake, files before those that are wanted are shown.
    leads: bool,
    /// The first picture after a reload is on its way.
    reload_pending: bool,
    /// What files say now came to nothing.
    is_load_bad: bool,
    screen_changed: bool,
    is_lost: bool,
    /// What was read last, of which frame and build.
    looked: Option<(Look, u64, u64)>,
    serial: u64,
    /// Only a part of the passes ran last.
    is_part: bool,
    /// The next frame runs passes whose results are there already, too.
    run_all: bool,
    /// That the worker is gone was told.
    told_gone: bool,
    /// A picture that is to be written.
    shot: Option<std::path::PathBuf>,
    counted: Counted,
}

impl Core {
    /// # Errors
    /// If the device refuses what every window needs, or files cannot be watched.
    pub fn new(gpu: Gpu, job: Option<Job>, news: impl Fn() + Send + 'static) -> Result<Self, Diagnostics> {
        let screen = Screen::new(&gpu)?;
        let info = gpu.info();
        let session = Session::new(gpu);
        let worker = Worker::start(session.builder(), news)?;
        let mut core = Self {
            session,
            screen,
            worker,
            state: State {
                device: format!("{} ({:?})", info.name, info.backend),
                patience: PATIENCE,
                ..State::default()
            },
            sources: Sources::new(),
            wants: Wants::default(),
            sent: Wants::default(),
            opening: None,
            resized: None,
            made: None,
            stepped_s: None,
            version: 0,
            in_flight: None,
            advanced: None,
            answered: When::Start,
            fed_s: 0.0,
            is_led: false,
            leads: false,
            reload_pending: false,
            is_load_bad: false,
            screen_changed: false,
            is_lost: false,
            looked: None,
            serial: 0,
            is_part: false,
            run_all: false,
            told_gone: false,
            shot: None,
            counted: Counted::default(),
        };
        if let Some(job) = job {
            core.open(job);
        }
        Ok(core)
    }

    pub fn gpu(&self) -> &Gpu {
        self.session.gpu()
    }

    pub fn plan(&self) -> Option<&Plan> {
        self.session.plan()
    }

    pub fn screen(&self) -> &Screen {
        &self.screen
    }

    /// Whether the screen's texture became another one since the last call.
    pub fn take_screen_change(&mut self) -> bool {
        std::mem::take(&mut self.screen_changed)
    }

    /// Another number for another plan.
    pub fn builds(&self) -> u64 {
        self.version
    }

    /// How often something was read back for looking at it.
    pub fn reads(&self) -> u64 {
        self.serial
    }

    /// Inputs of particles that are shown, with how many there are.
    pub fn particles(&self) -> Vec<(&str, usize)> {
        let inputs = self.session.content().into_iter().flat_map(|content| &content.inputs);
        let of_particles = inputs.filter_map(|(name, input)| match input {
            Input::Particles(particles) => Some((name.as_str(), particles.set.count)),
            _ => None,
        });
        of_particles.collect()
    }

    /// Whether a frame is being drawn.
    pub fn is_drawing(&self) -> bool {
        self.in_flight.is_some()
    }

    /// Shows another scene or file.
    pub fn open(&mut self, job: Job) {
        self.state.overrides.clear();
        self.state.switched_off.clear();
        (self.state.camera, self.state.home) = (None, None);
        (self.state.look, self.state.recording, self.state.hunt) = (None, None, None);
        self.state.viewpoints = viewpoints::load(&job.source);
        let repeats = self.state.clock.repeats;
        self.state.clock = super::clock::Clock { repeats, ..super::clock::Clock::default() };
        (self.answered, self.fed_s, self.leads) = (When::Start, 0.0, false);
        self.reopen(job);
    }

    /// Shows the same content in another way: camera and parameters stay.
    fn reopen(&mut self, job: Job) {
        self.state.busy = Some(Instant::now());
        self.state.job = Some(job.clone());
        match self.wants.viewport {
            Some(_) => self.worker.open(job),
            // The size is known with the first paint: nothing is planned twice.
            None => self.opening = Some(job),
        }
    }

    /// The size that the picture should have, in pixels.
    pub fn want_size(&mut self, size: [u32; 2]) {
        if size.contains(&0) {
            // A window without area shows nothing, and what it showed comes back with it.
            return;
        }
        let fixed = self.state.job.as_ref().and_then(|job| job.size);
        let wanted = Some(fixed.unwrap_or(size));
        if self.state.recording.is_some() && self.opening.is_none() {
            // All pictures of a sequence have one size, whatever panels open meanwhile.
            return;
        }
        if self.wants.viewport != wanted {
            // The first size is not waited for.
            self.resized = self.wants.viewport.map(|_| Instant::now());
            self.wants.viewport = wanted;
        }
        if let Some(job) = self.opening.take() {
            self.sent = self.wants.clone();
            self.worker.want(self.wants.clone());
            self.worker.open(job);
        }
    }

    /// Takes news, lets time pass and draws, if there is anything to do.
    pub fn tick(&mut self, now: Instant) -> Tick {
        let mut tick = Tick::default();
        if self.worker.is_gone() && !std::mem::replace(&mut self.told_gone, true) {
            let failed =
                Diagnostic::error(Code::USAGE, "the thread that reads files has failed: changes are no longer seen");
            tick.repaint |= self.fail(failed.hint("open the window anew, and please report what led here").into());
        }
        while let Some(round) = self.worker.take() {
            self.take(round);
            tick.repaint = true;
        }
        tick.repaint |= self.look_after_frame();
        if self.in_flight.is_none() && !self.is_lost {
            self.advance(now);
        }
        self.send_wants(now, &mut tick);
        if self.in_flight.is_none() && !self.is_lost {
            tick.repaint |= self.draw_if_changed();
        }
        // Before a frame of a sequence is there nothing is written or read: the worker wakes the window.
        if self.in_flight.is_none() && !self.is_lost && self.made.is_some() && self.is_fed() {
            tick.repaint |= self.at_rest();
        }
        tick.repaint |= !self.is_lost && self.count();
        let goes_on = self.state.hunt.is_some() || self.state.recording.is_some();
        let plays = self.state.clock.is_playing && self.session.plan().is_some();
        if self.in_flight.is_some() || self.counted.is_asked() {
            tick.again = Some(tick.again.map_or(POLL, |again| again.min(POLL)));
        } else if (goes_on || plays) && self.is_fed() {
            tick.again = Some(Duration::ZERO);
        }
        tick.is_lost = self.is_lost;
        tick
    }

    /// What is done between frames: pictures are written, resources read.
    fn at_rest(&mut self) -> bool {
        if let Some(path) = self.shot.clone() {
            if !self.end_part() {
                self.shot = None;
                self.shoot(&path);
            }
            return true;
        }
        if self.state.recording.is_some() {
            return !self.end_part() && self.record_frame();
        }
        if self.state.hunt.is_some() { self.hunt() } else { self.look() }
    }

    fn send_wants(&mut self, now: Instant, tick: &mut Tick) {
        self.wants.params.clone_from(&self.state.overrides);
        if !self.is_fed() {
            self.wants.when = self.next_when();
        }
        let looked_at = self.state.look.iter().map(|look| look.path.clone());
        self.wants.stats = self.state.counts;
        self.wants.roots = looked_at.filter(|path| self.can_be_root(path)).collect();
        if self.wants == self.sent {
            return;
        }
        let rest = self.resized.map(|at| RESIZE_REST.saturating_sub(now.saturating_duration_since(at)));
        match rest.filter(|rest| !rest.is_zero()) {
            Some(rest) => tick.again = Some(rest),
            None => {
                self.resized = None;
                self.sent = self.wants.clone();
                self.worker.want(self.wants.clone());
                if self.state.job.is_some() {
                    self.state.busy.get_or_insert(now);
                }
            }
        }
    }

    /// Resources of the graph get memory of their own while they are looked at; inputs have it.
    fn can_be_root(&self, path: &str) -> bool {
        self.session.plan().is_some_and(|plan| plan.names.contains_key(path))
    }

    /// Shows errors of the device or of a frame; the last good picture stays.
    fn fail(&mut self, found: Diagnostics) -> bool {
        self.is_lost |= any_device_gone(&found);
        self.state.findings = Some(Findings { diagnostics: found, sources: self.sources.clone(), is_stale: true });
        true
    }

    /// Goes on with another device after the last one was lost.
    ///
    /// # Errors
    /// If the new one refuses what every window needs.
    pub fn replace_device(&mut self, gpu: Gpu) -> Result<(), Diagnostic> {
        self.screen = Screen::new(&gpu)?;
        self.session = Session::new(gpu);
        (self.made, self.in_flight, self.is_lost) = (None, None, false);
        self.screen_changed = true;
        self.worker.build_with(self.session.builder());
        self.state.busy = Some(Instant::now());
        self.state.say("the device was lost: going on with a new one");
        Ok(())
    }
}
