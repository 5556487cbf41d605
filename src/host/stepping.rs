//! Coming to a moment: the steps before it are done, each with the files of sequences that show at its own time.
//!
//! A step does not know in which picture it is done, so that pictures of a moment are the same however one came to it.

use std::mem;

use super::build::Session;
use super::draw::{Drawn, Moment, nothing};
use super::player::Player;
use super::sequence::{Track, When};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::engine::Runner;
use crate::plan::model::{Plan, Steps, Unit};

/// Steps of one `Steps` that follow each other and see the same files.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Turn {
    /// Of the plan's `Steps`.
    index: usize,
    count: u32,
    /// When the last of them is, if they see sequences.
    at: Option<When>,
}

impl Session {
    /// Draws a moment with the files that show then. Steps go on from the moment that was drawn before, or begin
    /// anew where that was later.
    ///
    /// # Errors
    /// As [`Session::draw`], and if the files of a moment cannot be drawn.
    pub fn draw_at(&mut self, when: When, player: &mut Player, present: bool) -> Result<Drawn, Diagnostics> {
        let moment = when.moment(self.tracks().first());
        let mut anew = false;
        self.draw_by(present, moment, |session, notes| {
            // What was too small for one of the moments may have left something out of all that came after.
            let anew = mem::replace(&mut anew, true);
            session.come_to(moment, Some((&mut *player, when)), anew, notes)
        })
    }

    /// Whether steps see numbered files: not all of them those of the picture's moment.
    pub fn steps_see_files(&self) -> bool {
        self.plan().is_some_and(|plan| plan.steps.iter().any(|steps| sees(plan, steps, self.tracks())))
    }

    /// Whether steps at a rate do, which count what was left out.
    pub fn timed_steps_see_files(&self) -> bool {
        self.plan().is_some_and(|plan| stepping(plan, self.tracks()).next().is_some())
    }

    /// Does the steps that see the files of `shown` and were not done yet when those of `next` take their place. For
    /// windows, which draw what is due now and then.
    ///
    /// # Errors
    /// If the device refuses something or is lost.
    pub fn end_steps(&mut self, shown: When, next: When, only: Option<&[bool]>) -> Result<(), Diagnostics> {
        let Some(runner) = &self.graph else { return Ok(()) };
        let (plan, tracks) = (runner.plan(), self.tracks());
        let end_s = next.moment(tracks.first()).time_s;
        let mut turns = Vec::new();
        for index in stepping(plan, tracks) {
            let (steps, done) = (&plan.steps[index], runner.steps_done()[index]);
            let Some(rate) = steps.rate else { continue };
            let time = |step: u64| step as f64 / rate;
            let sees_shown = |time_s: f64| {
                let mut seen = tracks.iter().filter(|track| sees(plan, steps, std::slice::from_ref(track)));
                seen.all(|track| track.frames.frame(When::Time(time_s)) == track.frames.frame(shown))
            };
            let is_due = |step: &u64| time(*step) <= end_s && sees_shown(time(*step));
            let count = (done + 1..).zip(0..u32::MAX).take_while(|(step, _)| is_due(step)).count() as u32;
            turns.push((Turn { index, count, at: None }, time(done + u64::from(count))));
        }
        for (turn, time_s) in turns.into_iter().filter(|(turn, _)| turn.count > 0) {
            self.run_turn(turn, When::Time(time_s).moment(self.tracks().first()), only)?;
        }
        Ok(())
    }

    /// Does all steps up to a moment, and runs the graph for it. With a player, what shows is turned to the files of
    /// each moment on the way. Tells whether counted buffers had room enough.
    ///
    /// # Errors
    /// As [`Session::draw_at`].
    pub(super) fn come_to(
        &mut self,
        moment: Moment,
        mut player: Option<(&mut Player, When)>,
        anew: bool,
        notes: &mut Diagnostics,
    ) -> Result<bool, Diagnostics> {
        let first = self.tracks().first().map_or(0, |track| *track.frames.timeline.numbers.start());
        let runner = self.graph.as_mut().ok_or_else(nothing)?;
        let is_over = |(steps, done): (&Steps, &u64)| steps_until(steps, moment, first) < *done;
        let is_before = runner.plan().steps.iter().zip(runner.steps_done()).any(is_over);
        if (anew || is_before) && !runner.plan().steps.is_empty() {
            runner.reset_state(&self.engine)?;
        }
        // Before anything is done: there may be far too many.
        steps_due(runner, moment, first)?;
        let once = runner.plan().steps.iter().zip(runner.steps_done()).filter(|(steps, _)| steps.rate.is_none());
        // Steps at a rate only count time; those once a frame need each frame before.
        let next = once.map(|(_, done)| *done).min().map_or(moment.frame, |done| first.saturating_add(done));
        for frame in next.min(moment.frame)..=moment.frame {
            let is_last = frame == moment.frame;
            let at = When::Frame(frame);
            let now = if is_last { moment } else { at.moment(self.tracks().first()) };
            if let Some((player, when)) = &mut player {
                if !self.step_to(now, player, notes)? {
                    return Ok(false);
                }
                self.turn_to(if is_last { *when } else { at }, player, notes)?;
            }
            let steps = steps_due(self.graph.as_ref().ok_or_else(nothing)?, now, first)?;
            self.run_moment(now, &steps, None)?;
            if !is_last && self.lacked_room(notes)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Does the steps that see sequences, and what has to be done before them. Tells whether there was room enough.
    fn step_to(&mut self, now: Moment, player: &mut Player, notes: &mut Diagnostics) -> Result<bool, Diagnostics> {
        while let Some(turn) = self.next_turn(now) {
            let mut then = now;
            if let Some(at) = turn.at {
                then = at.moment(self.tracks().first());
                let before = self.path_and_done(turn.index);
                self.turn_to(at, player, notes)?;
                let after = self.path_and_done(turn.index);
                if before.as_ref().map(|(path, _)| path) != after.as_ref().map(|(path, _)| path) {
                    // With these files it is another plan.
                    continue;
                }
                if let (Some((path, before)), Some((_, after))) = (before, after)
                    && after < before
                {
                    let message = format!("`{path}` begins anew with each file, and sees that of the picture only");
                    let hint = "what it keeps changes with the number of particles: give it a size of its own";
                    notes.push(Diagnostic::warning(Code::STATE, message).hint(hint));
                    return Ok(true);
                }
            }
            self.run_turn(turn, then, None)?;
            if self.lacked_room(notes)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// What is to be done next of the steps that see sequences or come before such, in program order.
    fn next_turn(&self, now: Moment) -> Option<Turn> {
        let (runner, tracks) = (self.graph.as_ref()?, self.tracks());
        let plan = runner.plan();
        stepping(plan, tracks).find_map(|index| {
            let steps = &plan.steps[index];
            let rate = steps.rate?;
            let (done, until) = (runner.steps_done()[index], steps_until(steps, now, 0));
            if until <= done {
                return None;
            }
            let seen: Vec<&Track> =
                tracks.iter().filter(|track| sees(plan, steps, std::slice::from_ref(track))).collect();
            let at = |step: u64| When::Time(step as f64 / rate);
            let shown = |step: u64| seen.iter().map(move |track| track.frames.frame(at(step)));
            let is_alike = |step: &u64| shown(*step).eq(shown(done + 1));
            let last = if seen.is_empty() { until } else { (done + 1..=until).take_while(is_alike).last()? };
            let count = u32::try_from(last - done).unwrap_or(u32::MAX);
            Some(Turn { index, count, at: (!seen.is_empty()).then(|| at(last)) })
        })
    }

    /// Runs steps, with what comes before them in the program.
    fn run_turn(&mut self, turn: Turn, now: Moment, only: Option<&[bool]>) -> Result<(), Diagnostics> {
        let plan = self.plan().ok_or_else(nothing)?;
        let end = plan.steps.get(turn.index).map_or(0, |steps| steps.passes.end);
        let is_asked = |pass: usize| only.is_none_or(|only| only.get(pass) != Some(&false));
        let only: Vec<bool> = (0..plan.passes.len()).map(|pass| pass < end && is_asked(pass)).collect();
        let steps: Vec<u32> = (0..plan.steps.len()).map(|at| if at == turn.index { turn.count } else { 0 }).collect();
        self.run_moment(now, &steps, Some(&only))
    }

    /// Puts the files of a moment in the place of those before.
    ///
    /// # Errors
    /// If they cannot be drawn.
    pub fn turn_to(&mut self, when: When, player: &mut Player, notes: &mut Diagnostics) -> Result<(), Diagnostics> {
        let inputs = player.inputs(when, notes);
        notes.extend(self.feed(inputs)?);
        Ok(())
    }

    /// The path of a `Steps`, and how many of it are done.
    fn path_and_done(&self, index: usize) -> Option<(String, u64)> {
        let runner = self.graph.as_ref()?;
        Some((runner.plan().steps.get(index)?.path.clone(), *runner.steps_done().get(index)?))
    }
}

/// The `Steps` at a rate that see sequences, and those before them, in program order.
fn stepping(plan: &Plan, tracks: &[Track]) -> impl Iterator<Item = usize> + use<> {
    let mut all: Vec<usize> = (0..plan.steps.len()).filter(|index| plan.steps[*index].rate.is_some()).collect();
    all.sort_by_key(|index| plan.steps[*index].passes.start);
    let last = all.iter().rposition(|index| sees(plan, &plan.steps[*index], tracks));
    all.truncate(last.map_or(0, |last| last + 1));
    all.into_iter()
}

/// Whether steps see files that are others at other times.
fn sees(plan: &Plan, steps: &Steps, tracks: &[Track]) -> bool {
    let stepped = |unit: &&Unit| unit.passes.iter().any(|pass| steps.passes.contains(pass));
    let mut units = plan.units.iter().filter(stepped);
    let moving: Vec<&str> = tracks.iter().filter(|track| track.frames.moves()).map(|t| t.input.as_str()).collect();
    units.any(|unit| moving.iter().any(|input| unit.causes.inputs.contains(*input)))
}

/// How many steps are done at a moment: at a rate, as many as the time asks for; else one, from the frame `first` on.
fn steps_until(steps: &Steps, now: Moment, first: u64) -> u64 {
    match steps.rate {
        Some(rate) => (now.time_s * rate).floor().max(0.0) as u64,
        None => now.frame - first.min(now.frame) + 1,
    }
}

/// How many steps each `Steps` has yet to run until a moment.
///
/// # Errors
/// If they are more than anybody could wait for.
fn steps_due(runner: &Runner, now: Moment, first: u64) -> Result<Vec<u32>, Diagnostic> {
    let due = |(steps, done): (&Steps, &u64)| {
        let until = steps_until(steps, now, first);
        u32::try_from(until.saturating_sub(*done)).map_err(|_| {
            let message = format!("`{}` would run {until} steps until {} s", steps.path, now.time_s);
            Diagnostic::error(Code::USAGE, message).hint("ask for an earlier time")
        })
    };
    runner.plan().steps.iter().zip(runner.steps_done()).map(due).collect()
}
