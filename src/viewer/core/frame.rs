//! Frames: whether another one is due, drawing it, and what it told when it is done.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::Core;
use crate::diagnostic::Diagnostics;
use crate::host::{Due, Live, When};
use crate::scene::Camera;

/// Steps of simulations that run in one frame while time plays, and while it catches up.
const MOST_STEPS: [u32; 2] = [4, 32];

/// What a frame was made of, to tell whether the next one would differ.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Made {
    camera: Camera,
    time_s: f64,
    only: Option<Vec<bool>>,
    /// Counts builds and resets.
    version: u64,
}

#[derive(Debug)]
pub(super) struct InFlight {
    done: Arc<AtomicBool>,
    since: Instant,
}

impl Core {
    pub(super) fn advance(&mut self, now: Instant) {
        if !self.is_fed() {
            // Time waits for the frame of a sequence: none is left out.
            return;
        }
        let real_s = self.advanced.map_or(0.0, |before| now.saturating_duration_since(before).as_secs_f64());
        self.advanced = self.state.clock.is_playing.then_some(now);
        if self.state.changes_over_time {
            self.state.clock.advance(real_s);
        } else {
            self.state.clock.is_playing = false;
        }
    }

    /// Whether the frames of sequences at the clock's time are there.
    pub(super) fn is_fed(&self) -> bool {
        let clock = &self.state.clock;
        clock.frame_of(self.answered) == clock.frame() || clock.beat.last.is_none()
    }

    /// What is asked for of sequences. Where steps see the files of their own times, that is one frame after the
    /// other, from the first on if time goes back.
    pub(super) fn next_when(&mut self) -> When {
        let clock = &self.state.clock;
        let (shown, wanted) = (clock.frame_of(self.answered), clock.frame());
        if !self.is_led {
            return clock.when();
        }
        let next = if wanted > shown { shown + 1 } else { clock.beat.first };
        self.leads |= next != wanted || wanted < shown;
        When::Frame(next)
    }

    pub(super) fn only(&self) -> Option<Vec<bool>> {
        let off = &self.state.switched_off;
        let plan = self.session.plan().filter(|_| !off.is_empty())?;
        Some(plan.passes.iter().map(|pass| !off.contains(&pass.path)).collect())
    }

    /// Draws a frame if it would differ from the last one. Tells whether errors came up.
    pub(super) fn draw_if_changed(&mut self) -> bool {
        let (Some(camera), Some(_)) = (self.state.camera, self.session.content()) else { return false };
        let is_fed = self.is_fed();
        if is_fed {
            (self.fed_s, self.leads) = (self.state.clock.time_s, false);
        }
        if self.leads {
            // What shows on the way to another frame is nobody's picture.
            return false;
        }
        // Else the frame that is there is drawn on, as the camera moves.
        let made = Made { camera, time_s: self.fed_s, only: self.only(), version: self.version };
        let is_new = self.stepped_s != Some(made.time_s);
        // Steps that see files wait for them.
        let may_step = is_fed || !self.is_led;
        let mut due =
            if may_step { self.session.steps_due(made.time_s, is_new, MOST_STEPS[0]) } else { Due::default() };
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
            delta_s: if is_fed { self.state.clock.delta_s } else { 0.0 },
            frame: self.state.clock.frame_at(made.time_s),
            steps: &due.steps,
            only: made.only.as_deref(),
        };
        self.stepped_s = Some(made.time_s);
        self.made = Some(made.clone());
        self.session.run_all(self.run_all || self.state.runs_all);
        // Software drivers draw while they take the commands.
        let began = Instant::now();
        let ran = self.session.submit(&live);
        let drawn = ran.and_then(|report| {
            self.run_all = false;
            self.state.units = report.units;
            self.session.show(&live, &mut self.screen)
        });
        self.state.handing_over = began.elapsed();
        match drawn {
            Ok(changed) => {
                self.screen_changed |= changed;
                self.watch_frame(began);
                false
            }
            Err(found) => self.fail(found),
        }
    }

    fn watch_frame(&mut self, since: Instant) {
        let done = Arc::new(AtomicBool::new(false));
        let told = Arc::clone(&done);
        self.session.gpu().when_done(move || told.store(true, Ordering::Release));
        self.in_flight = Some(InFlight { done, since });
    }

    /// Whether the frame on its way is done; its times and counts are taken then.
    pub(super) fn look_after_frame(&mut self) -> bool {
        let Some(in_flight) = &self.in_flight else { return false };
        self.session.gpu().poll();
        if let Err(gone) = self.session.gpu().check() {
            self.in_flight = None;
            return self.fail(gone.into());
        }
        if !in_flight.done.load(Ordering::Acquire) {
            let waited = in_flight.since.elapsed();
            let seconds = waited.as_secs();
            let is_long = waited >= self.state.patience && seconds != self.state.waited_s;
            if is_long {
                self.state.waited_s = seconds;
                self.state.say(format!("the device has been drawing for {seconds} s: a shader may loop for ever"));
            }
            return is_long;
        }
        let took = in_flight.since.elapsed();
        let drawing_ms = took.as_secs_f64() * 1e3;
        if took >= self.state.patience && self.state.waited_s == 0 {
            let seconds = took.as_secs_f64();
            self.state.say(format!(
                "drawing took {seconds:.1} s: the driver compiled something large, or a shader loops for long"
            ));
        }
        self.state.waited_s = 0;
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

    pub(super) fn note(&mut self, notes: &Diagnostics) {
        if let Some(first) = notes.iter().next() {
            self.state.say(first.message.clone());
        }
    }
}
