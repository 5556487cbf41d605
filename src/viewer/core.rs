//! What happens in the window, without a window: news from the worker, frames for the device,
//! and what a person asked for.

mod files;
mod look;
mod record;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::action::Action;
use super::camera;
use super::editor;
use super::look::Look;
use super::params::{self, groups};
use super::state::{Findings, Reload, State, bounds, listed, short};
use super::viewpoints;
use super::worker::{Cause, Round, Wants, Worker};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity, Sources};
use crate::engine::{Gpu, Screen, any_device_gone};
use crate::graph::value::Value;
use crate::host::{Built, Content, Input, Job, Live, Session};
use crate::plan::model::Plan;
use crate::scene::{Camera, Pointing};

pub use look::Hunt;
pub use record::{Recording, free_name};

/// A window that is being resized asks for another picture size after this rest.
const RESIZE_REST: Duration = Duration::from_millis(120);
/// How often an unfinished frame is looked after.
const POLL: Duration = Duration::from_millis(2);
/// Steps of simulations that run in one frame while time plays, and while it catches up.
const MOST_STEPS: [u32; 2] = [4, 32];

/// A frame that takes longer is told.
const LONG_S: u64 = 10;

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

/// What a frame was made of, to tell whether the next one would differ.
#[derive(Clone, Debug, PartialEq)]
struct Made {
    camera: Camera,
    time_s: f64,
    only: Option<Vec<bool>>,
    /// Counts builds and resets.
    version: u64,
}

#[derive(Debug)]
struct InFlight {
    done: Arc<AtomicBool>,
    since: Instant,
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
    /// The first picture after a reload is on its way.
    reload_pending: bool,
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
            state: State { device: format!("{} ({:?})", info.name, info.backend), ..State::default() },
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
            reload_pending: false,
            screen_changed: false,
            is_lost: false,
            looked: None,
            serial: 0,
            is_part: false,
            run_all: false,
            told_gone: false,
            shot: None,
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

    /// How often something was read back for looking at it.
    pub fn reads(&self) -> u64 {
        self.serial
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
        self.state.clock = super::clock::Clock::default();
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
        let fixed = self.state.job.as_ref().and_then(|job| job.size);
        let wanted = Some(fixed.unwrap_or(size));
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
        self.send_wants(now, &mut tick);
        if self.in_flight.is_none() && !self.is_lost {
            self.advance(now);
            tick.repaint |= self.draw_if_changed();
        }
        if self.in_flight.is_none() && !self.is_lost && self.made.is_some() {
            tick.repaint |= self.at_rest();
        }
        if self.state.hunt.is_some() || self.state.recording.is_some() {
            tick.again = Some(Duration::ZERO);
        }
        if self.in_flight.is_some() {
            tick.again = Some(tick.again.map_or(POLL, |again| again.min(POLL)));
        } else if self.state.clock.is_playing && self.session.plan().is_some() {
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
        let looked_at = self.state.look.iter().map(|look| look.path.clone());
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

    fn advance(&mut self, now: Instant) {
        let real_s = self.advanced.map_or(0.0, |before| now.saturating_duration_since(before).as_secs_f64());
        self.advanced = self.state.clock.is_playing.then_some(now);
        if self.state.changes_over_time {
            self.state.clock.advance(real_s);
        } else {
            self.state.clock.is_playing = false;
        }
    }

    fn only(&self) -> Option<Vec<bool>> {
        let off = &self.state.switched_off;
        let plan = self.session.plan().filter(|_| !off.is_empty())?;
        Some(plan.passes.iter().map(|pass| !off.contains(&pass.path)).collect())
    }

    /// Draws a frame if it would differ from the last one. Tells whether errors came up.
    fn draw_if_changed(&mut self) -> bool {
        let (Some(camera), Some(_)) = (self.state.camera, self.session.content()) else { return false };
        let made = Made { camera, time_s: self.state.clock.time_s, only: self.only(), version: self.version };
        let is_new = self.stepped_s != Some(made.time_s);
        let mut due = self.session.steps_due(made.time_s, is_new, MOST_STEPS[0]);
        let catches_up = due.steps.iter().any(|steps| *steps > 0) || due.needs_reset;
        if self.made.as_ref() == Some(&made) && !catches_up {
            return false;
        }
        if due.needs_reset {
            if let Err(error) = self.session.reset() {
                return self.fail(error.into());
            }
            due = self.session.steps_due(made.time_s, is_new, MOST_STEPS[1]);
        } else if due.is_behind && !self.state.clock.is_playing {
            due = self.session.steps_due(made.time_s, is_new, MOST_STEPS[1]);
        }
        let live = Live {
            camera,
            time_s: made.time_s,
            delta_s: self.state.clock.delta_s,
            frame: self.state.clock.frame(),
            steps: &due.steps,
            only: made.only.as_deref(),
        };
        self.stepped_s = Some(made.time_s);
        self.made = Some(made.clone());
        self.session.run_all(self.run_all || self.state.runs_all);
        let ran = self.session.submit(&live);
        let drawn = ran.and_then(|report| {
            self.run_all = false;
            self.state.units = report.units;
            self.session.show(&live, &mut self.screen)
        });
        match drawn {
            Ok(changed) => {
                self.screen_changed |= changed;
                self.watch_frame();
                false
            }
            Err(found) => self.fail(found),
        }
    }

    fn watch_frame(&mut self) {
        let done = Arc::new(AtomicBool::new(false));
        let told = Arc::clone(&done);
        self.session.gpu().when_done(move || told.store(true, Ordering::Release));
        self.in_flight = Some(InFlight { done, since: Instant::now() });
    }

    /// Whether the frame on its way is done; its times and counts are taken then.
    fn look_after_frame(&mut self) -> bool {
        let Some(in_flight) = &self.in_flight else { return false };
        self.session.gpu().poll();
        if let Err(gone) = self.session.gpu().check() {
            self.in_flight = None;
            return self.fail(gone.into());
        }
        if !in_flight.done.load(Ordering::Acquire) {
            let seconds = in_flight.since.elapsed().as_secs();
            let is_long = seconds >= LONG_S && seconds != self.state.waited_s;
            if is_long {
                self.state.waited_s = seconds;
                self.state.say(format!("the device has been drawing for {seconds} s: a shader may loop for ever"));
            }
            return is_long;
        }
        let drawing_ms = in_flight.since.elapsed().as_secs_f64() * 1e3;
        self.in_flight = None;
        self.state.frames += 1;
        if std::mem::take(&mut self.reload_pending)
            && let Some(reload) = self.state.reloads.front_mut()
        {
            reload.drawing_ms = Some(drawing_ms);
        }
        let [graph, present] = self.session.answers();
        if let Some(report) = present {
            self.state.times[1].take(report);
        }
        if let Some(report) = graph {
            match self.session.wants_room(&report) {
                Ok(Some(notes)) => {
                    self.worker.build_with(self.session.builder());
                    self.state.busy.get_or_insert_with(Instant::now);
                    self.note(&notes);
                }
                Ok(None) => {}
                Err(found) => _ = self.fail(found),
            }
            self.state.times[0].take(report);
        }
        true
    }

    fn note(&mut self, notes: &Diagnostics) {
        if let Some(first) = notes.iter().next() {
            self.state.say(first.message.clone());
        }
    }

    /// Shows errors of the device or of a frame; the last good picture stays.
    fn fail(&mut self, found: Diagnostics) -> bool {
        self.is_lost |= any_device_gone(&found);
        self.state.findings = Some(Findings { diagnostics: found, sources: self.sources.clone(), is_stale: true });
        true
    }

    fn take(&mut self, round: Round) {
        self.state.busy = None;
        let Round { cause, planned, read, mut diagnostics, sources, noticing, checking, building } = round;
        if let Some(read) = &read {
            self.take_content(read);
        }
        let began = Instant::now();
        let mut built = None;
        if let Some(planned) = planned {
            let is_first = self.session.content().is_none();
            match self.session.install(*planned) {
                Ok(made) => {
                    self.installed(&made, is_first);
                    diagnostics.extend(made.diagnostics.clone());
                    self.sources.clone_from(&sources);
                    built = Some(made);
                }
                Err(found) => {
                    self.is_lost |= any_device_gone(&found);
                    diagnostics.extend(found);
                }
            }
        }
        let (errors, warnings) = (diagnostics.count(Severity::Error), diagnostics.count(Severity::Warning));
        if cause != Cause::Wanted {
            self.state.log(Reload {
                at: Instant::now(),
                what: match &cause {
                    Cause::Opened(path) => format!("opened {}", short(path)),
                    Cause::Changed(files) if files.is_empty() => "reloaded".into(),
                    Cause::Changed(files) => listed(files),
                    Cause::Wanted => String::new(),
                },
                is_good: built.is_some(),
                errors,
                warnings,
                noticing_ms: ms(noticing),
                checking_ms: ms(checking),
                building_ms: ms(building) + ms(began.elapsed()),
                drawing_ms: None,
                pipelines_built: built.as_ref().map_or(0, |b| b.pipelines_built),
                pipelines_kept: built.as_ref().map_or(0, |b| b.pipelines_reused),
            });
            self.reload_pending = built.is_some();
        }
        let is_stale = built.is_none();
        self.state.findings = (!diagnostics.is_empty()).then_some(Findings { diagnostics, sources, is_stale });
    }

    /// What files say by now.
    fn take_content(&mut self, content: &Content) {
        params::settle(&mut self.state.overrides, content);
        let present = content.present_params.iter().map(|(path, v)| (format!("{}{path}", params::PRESENT), v.clone()));
        let own = content.params.iter().map(|(path, v)| (path.clone(), v.clone()));
        self.state.in_scene = own.chain(present).collect();
        self.state.bounds = bounds(content);
        let home = self.state.home.replace(content.camera);
        // A camera that was not moved by hand follows the scene's.
        if self.state.camera.is_none() || self.state.camera == home {
            self.state.camera = Some(content.camera);
        }
    }

    fn installed(&mut self, built: &Built, _is_first: bool) {
        self.version += 1;
        self.state.memory_bytes = built.memory_bytes;
        self.state.changes_over_time = self.session.changes_over_time();
        let mut inputs = self.session.content().into_iter().flat_map(|content| content.inputs.values());
        self.state.takes_pointer = inputs.any(|input| matches!(input, Input::Pointer(_)));
        if let Some(plan) = self.session.plan() {
            self.state.viewport = plan.viewport;
            self.state.groups = groups(plan, self.session.present_plan());
            self.state.times[0].keep(|path| plan.passes.iter().any(|p| p.path == path));
        }
    }

    pub fn act(&mut self, action: Action) {
        match action {
            Action::Open(path) => self.open_path(path),
            Action::Set { path, value } => self.set(path, value),
            Action::ResetParams => self.state.overrides.clear(),
            Action::Camera(camera) => {
                if camera.fault().is_none() {
                    self.state.camera = Some(camera);
                }
            }
            Action::Frame => {
                if let (Some(camera), Some([low, high])) = (self.state.camera, self.state.bounds) {
                    self.state.camera = Some(camera::frame(&camera, low, high, self.state.viewport));
                }
            }
            Action::Home => self.state.camera = self.state.home.or(self.state.camera),
            Action::Restart => self.restart(),
            Action::Reload => {
                self.state.busy = Some(Instant::now());
                self.worker.reload();
            }
            Action::SaveParams => self.save_params(),
            Action::SaveCamera => self.save_camera(),
            Action::Edit { path, line, column } => {
                if let Err(why) = editor::open(&path, line, column) {
                    self.state.say(why);
                }
            }
            Action::Point { at, is_pressed } => self.point(at, is_pressed),
            Action::Keep(slot) => {
                let Some(camera) = self.state.camera else { return };
                self.state.viewpoints.insert(slot, camera);
                let kept = self.state.job.as_ref().map(|job| viewpoints::save(&job.source, &self.state.viewpoints));
                match kept {
                    Some(Err(why)) => self.state.say(format!("the viewpoint is kept until you close: {why}")),
                    _ => self.state.say(format!("viewpoint {slot} was kept")),
                }
            }
            Action::GoTo(slot) => {
                if let Some(camera) = self.state.viewpoints.get(&slot) {
                    self.state.camera = Some(*camera);
                }
            }
            Action::RunAll(on) => {
                self.state.runs_all = on;
                self.version += 1;
            }
            Action::Look(look) => self.state.look = look,
            Action::Hunt => self.state.hunt = Some(Hunt::default()),
            Action::Shoot(path) => self.shot = Some(path),
            Action::Record(recording) => self.record(recording),
            Action::StopRecording => self.state.recording = None,
            Action::Play(on) => self.state.clock.is_playing = on,
            Action::Step(frames) => self.state.clock.step(frames),
            Action::Seek(time_s) => self.state.clock.seek(time_s),
            Action::Speed(speed) => self.state.clock.speed = speed,
            Action::Switch { pass, on } => {
                if on {
                    self.state.switched_off.remove(&pass);
                } else {
                    self.state.switched_off.insert(pass);
                }
            }
        }
    }

    fn set(&mut self, path: String, value: Option<Value>) {
        let shown = self.state.groups.iter().flat_map(|g| &g.params).find(|p| p.path == path);
        let declared = shown.and_then(|p| p.param.default.clone());
        let said = self.state.in_scene.get(&path).cloned().or(declared);
        match value.filter(|value| said.as_ref() != Some(value)) {
            Some(value) => _ = self.state.overrides.insert(path, value),
            None => _ = self.state.overrides.remove(&path),
        }
    }

    /// A pointer of the graph is where a person points, from now on.
    fn point(&mut self, at: [f64; 2], is_pressed: bool) {
        let Some(camera) = self.state.camera else { return };
        let direction = camera::ray(&camera, at, self.state.viewport);
        self.session.point(Pointing { time_s: self.state.clock.time_s, origin: camera.eye, direction, is_pressed });
    }

    fn restart(&mut self) {
        self.session.forget_pointing();
        self.state.clock.seek(0.0);
        self.version += 1;
        self.stepped_s = None;
        if let Err(error) = self.session.reset() {
            self.fail(Diagnostics::from(error));
        }
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

fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
