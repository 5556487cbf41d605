//! Carrying out a frame: one encoder, passes in program order, `Steps` as often as asked.

use std::collections::BTreeMap;
use std::ops::Range;
use std::time::Instant;

use super::bind::{Bench, Variant, references};
use super::encode::Recorder;
use super::errors;
use super::gpu::Gpu;
use super::prepare::{Engine, Runner};
use super::report::Report;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::graph::value::Value;
use crate::plan::model::{ObjectRef, Origin, Plan, Policy};

/// What changes from frame to frame.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// Seconds.
    pub time: f64,
    /// Seconds since the frame before.
    pub delta: f64,
    pub frame: u64,
    /// For each of the plan's `Steps`, how many to run now; absent ones run none.
    pub steps: &'a [u32],
    /// Gives live names (`camera.position`, `sun.direction`) their values; inside `Steps` those
    /// of the step. `time`, `delta`, `frame` and `step` need no answer: what it leaves out, the
    /// engine knows.
    pub live: &'a dyn Fn(&str, Option<&StepInfo>) -> Option<Value>,
    /// Which passes run, by index into the plan's; absent: all.
    pub only: Option<&'a [bool]>,
}

impl std::fmt::Debug for Frame<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Frame")
            .field("time", &self.time)
            .field("delta", &self.delta)
            .field("frame", &self.frame)
            .field("steps", &self.steps)
            .field("only", &self.only)
            .finish_non_exhaustive()
    }
}

/// Which step of which `Steps` runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInfo {
    /// Index into the plan's `steps`.
    pub steps: usize,
    /// Steps since the last reset: 0 initialises.
    pub step: u64,
    /// Seconds: where the step ends, so that after `floor(t * rate)` steps the last one's time
    /// is the frame's. Once a frame: the frame's.
    pub time: f64,
    pub delta: f64,
}

impl Runner {
    /// Runs what has to run for a frame; waits for nothing. If nothing has to, no command goes to
    /// the device.
    ///
    /// # Errors
    /// If a live name has no value, the device refuses something, or it was lost. What is on
    /// the GPU may then be of no frame, and the steps count as not done.
    pub fn run(&mut self, engine: &Engine, frame: &Frame<'_>) -> Result<Report, Diagnostics> {
        self.frame_into(engine, frame, None)?;
        Ok(self.report())
    }

    /// The same without a report, for those who draw all the time: where nothing new comes up, it
    /// allocates nothing. [`Runner::poll`] has the report once the GPU answered.
    ///
    /// # Errors
    /// As [`Runner::run`].
    pub fn advance(&mut self, engine: &Engine, frame: &Frame<'_>) -> Result<(), Diagnostics> {
        self.frame_into(engine, frame, None)
    }

    /// The same as [`Runner::advance`] into an embedder's commands, who submits them: after everything
    /// that was encoded before, and before the next frame of this runner is encoded or another plan takes
    /// its place. The report of the frame comes by [`Runner::poll`] once they were.
    ///
    /// # Errors
    /// As [`Runner::run`]; what the device refuses of the commands is told with the next frame.
    pub fn encode(
        &mut self,
        engine: &Engine,
        frame: &Frame<'_>,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), Diagnostics> {
        self.frame_into(engine, frame, Some(encoder))
    }

    fn frame_into(
        &mut self,
        engine: &Engine,
        frame: &Frame<'_>,
        into: Option<&mut wgpu::CommandEncoder>,
    ) -> Result<(), Diagnostics> {
        let gpu = engine.gpu();
        gpu.check()?;
        let began = Instant::now();
        self.fill_inputs(gpu)?;
        let steps = self.step_infos(frame);
        let ran = self.carry_out(gpu, frame, &steps, (began, into));
        self.due = steps;
        ran
    }

    fn carry_out(
        &mut self,
        gpu: &Gpu,
        frame: &Frame<'_>,
        steps: &[StepInfo],
        (began, into): (Instant, Option<&mut wgpu::CommandEncoder>),
    ) -> Result<(), Diagnostics> {
        let live =
            |name: &str, step: Option<&StepInfo>| (frame.live)(name, step).or_else(|| own_value(frame, name, step));
        self.notice(&|name| live(name, None));
        let runs_any = self.changes.decide(frame.steps, self.runs_all, self.plan.memory.policy != Policy::Keep);
        self.timing.begin(gpu, &self.plan, frame.frame, runs(&self.plan, steps));
        self.timing.decided(self.changes.decision());
        if !runs_any {
            self.changes.done(&self.plan, frame.steps, frame.only);
            self.timing.uploaded(gpu.uploaded_bytes());
            self.timing.submitted(began.elapsed().as_secs_f64() * 1e3);
            return Ok(());
        }
        self.uniforms.write_frame(gpu, &self.plan, &self.changes, &live)?;
        self.uniforms.stage_steps(gpu, &self.plan, steps, &live)?;
        self.before.0.clone_from(&self.rotation);
        self.before.1.clone_from(&self.done);
        let chosen = self.choose(frame.only);
        let recorder = into.map_or_else(|| Recorder::new(gpu), Recorder::within);
        let encoded = self.record_frame(gpu, &Frame { only: Some(&chosen), ..*frame }, steps, recorder);
        self.chosen = chosen;
        if let Err(diagnostic) = encoded {
            self.rotation.clone_from(&self.before.0);
            self.done.clone_from(&self.before.1);
            self.changes.failed();
            return Err(diagnostic.into());
        }
        self.timing.uploaded(gpu.uploaded_bytes());
        self.timing.submitted(began.elapsed().as_secs_f64() * 1e3);
        self.stamp();
        match gpu.check() {
            Ok(()) => {
                self.changes.done(&self.plan, frame.steps, frame.only);
                Ok(())
            }
            Err(refused) => {
                self.changes.failed();
                let is_lost = errors::is_device_gone(&refused);
                Err(self.blame(gpu).filter(|_| !is_lost).unwrap_or_else(|| refused.into()))
            }
        }
    }

    /// Which passes run: of those that somebody chose, those that have to.
    fn choose(&mut self, only: Option<&[bool]>) -> Vec<bool> {
        let mut chosen = std::mem::take(&mut self.chosen);
        chosen.clear();
        chosen.extend(self.parts.iter().enumerate().map(|(index, (in_steps, unit))| {
            let is_left_out = only.is_some_and(|only| only.get(index) == Some(&false));
            !is_left_out && (*in_steps || self.changes.runs(*unit))
        }));
        chosen
    }

    /// What is known of the frame before the GPU answers.
    fn report(&self) -> Report {
        self.timing.preliminary(&self.plan, &self.changes)
    }

    /// Waits until the GPU is done and gives the last frame's report, with times and counts.
    ///
    /// # Errors
    /// If the device was lost, refused something, or does not end.
    pub fn finish(&mut self, engine: &Engine) -> Result<Report, Diagnostic> {
        let gpu = engine.gpu();
        gpu.wait()?;
        self.timing.collect();
        if self.timing.is_idle() {
            return Ok(self.idle_report());
        }
        if !self.timing.is_captured() {
            // All buffers were on their way when the frame was submitted; now they are back.
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.timing.capture(gpu, &mut encoder, &self.fixed.stats);
            gpu.queue().submit([encoder.finish()]);
            let now = self.report();
            self.timing.submitted(now.encode_ms + now.submit_ms);
            gpu.wait()?;
            self.timing.collect();
        }
        let report = self.timing.take(&self.plan, &self.changes).or_else(|| self.last.clone());
        self.last.clone_from(&report);
        Ok(report.unwrap_or_else(|| self.report()))
    }

    /// The report of a frame for which nothing had to run: the counts are those of the frame that
    /// made them.
    fn idle_report(&mut self) -> Report {
        let newest = self.timing.take(&self.plan, &self.changes);
        self.last = newest.or(self.last.take());
        let counts = self.last.as_ref().map(|last| last.counts.clone()).unwrap_or_default();
        Report { counts, complete: true, ..self.report() }
    }

    /// The newest report whose times and counts have come, once each. Does not wait.
    pub fn poll(&mut self, engine: &Engine) -> Option<Report> {
        engine.gpu().poll();
        self.timing.collect();
        let report = self.timing.take(&self.plan, &self.changes);
        if report.is_some() {
            self.last.clone_from(&report);
        }
        report
    }

    /// Whether GPU times are taken, where the device can.
    pub fn time_passes(&mut self, on: bool) {
        self.timing.turn(on);
    }

    /// How many steps each `Steps` has done since its reset.
    pub fn steps_done(&self) -> &[u64] {
        &self.done
    }

    /// Inputs that nobody filled or shared get zeroed memory.
    fn fill_inputs(&mut self, gpu: &Gpu) -> Result<(), Diagnostics> {
        if self.inputs_filled {
            return Ok(());
        }
        let mut found = Diagnostics::new();
        for object in 0..self.plan.objects.len() {
            // What passes write had its memory from the start, if any pass does.
            if self.plan.objects[object].origin == Origin::Frame {
                continue;
            }
            match self.pool.ensure(gpu, &self.plan, object) {
                Ok(true) => self.forget_variants(object),
                Ok(false) => {}
                Err(diagnostic) => found.push(diagnostic),
            }
        }
        self.inputs_filled = found.is_empty();
        if found.is_empty() { Ok(()) } else { Err(found) }
    }

    /// The steps of a frame in the order in which they run.
    fn step_infos(&mut self, frame: &Frame<'_>) -> Vec<StepInfo> {
        let mut infos = std::mem::take(&mut self.due);
        infos.clear();
        for steps in &self.steps_in_order {
            let (rate, done) = (self.plan.steps[*steps].rate, self.done[*steps]);
            let times = frame.steps.get(*steps).copied().unwrap_or(0);
            infos.extend((done..done + u64::from(times)).map(|step| {
                let (time, delta) = match rate {
                    Some(rate) => ((step + 1) as f64 / rate, 1.0 / rate),
                    None => (frame.time, frame.delta),
                };
                StepInfo { steps: *steps, step, time, delta }
            }));
        }
        infos
    }

    fn record_frame(
        &mut self,
        gpu: &Gpu,
        frame: &Frame<'_>,
        steps: &[StepInfo],
        mut recorder: Recorder<'_>,
    ) -> Result<(), Diagnostic> {
        let is_own = recorder.is_own();
        self.begin_parts(gpu, is_own)?;
        self.clear_counts(recorder.encoder(), frame.only);
        let mut staged = 0;
        let mut at = 0;
        while at < self.plan.passes.len() {
            self.cut(gpu, &mut recorder, at)?;
            let Some(block) = self.plan.steps.iter().position(|s| s.passes.contains(&at)) else {
                let next = (at..self.plan.passes.len()).find(|p| self.plan.steps.iter().any(|s| s.passes.start == *p));
                let end = next.unwrap_or(self.plan.passes.len()).max(at + 1);
                let end = self.cuts.next(at).map_or(end, |cut| end.min(cut));
                self.encode_range(gpu, frame.only, &mut recorder, at..end)?;
                at = end;
                continue;
            };
            let range = self.plan.steps[block].passes.clone();
            for info in steps.iter().filter(|info| info.steps == block) {
                self.uniforms.begin_step(recorder.encoder(), block, &mut staged);
                self.encode_range(gpu, frame.only, &mut recorder, range.clone())?;
                self.turn(info);
            }
            at = range.end.max(at + 1);
        }
        // Of somebody else's commands only the device tells whether they ran.
        if recorder.is_own() && !self.timing.has_questions() {
            self.timing.know();
        } else {
            self.timing.capture(gpu, recorder.encoder(), &self.fixed.stats);
        }
        self.timing.handed_over(recorder.end(gpu));
        self.end_parts(is_own);
        Ok(())
    }

    /// Clears the counts of the settling passes that run. Others keep what they counted.
    fn clear_counts(&self, encoder: &mut wgpu::CommandEncoder, chosen: Option<&[bool]>) {
        let mut run = 0..0;
        for (stat, index) in self.settles.iter().copied() {
            if chosen.is_some_and(|chosen| chosen.get(index) == Some(&false)) {
                continue;
            }
            if run.end != stat {
                clear_words(encoder, &self.fixed.stats, &run);
                run.start = stat;
            }
            run.end = stat + 1;
        }
        clear_words(encoder, &self.fixed.stats, &run);
    }

    /// Makes what the pass needs for the current rotation, if it is not there.
    pub(super) fn ensure_variant(&mut self, gpu: &Gpu, index: usize) -> Result<usize, Diagnostic> {
        let key = self.rotation_key(index);
        if self.variants[index].get(key).is_some() {
            return Ok(key);
        }
        let bench = self.bench(gpu);
        let pipeline = self.pipelines[index].as_deref();
        let pass = &self.plan.passes[index];
        let variant = errors::scoped(gpu, || bench.variant(index, pipeline))
            .and_then(|made| made)
            .map_err(|e| errors::refused("what is bound to", &pass.path, pass.span, &e))?;
        self.variants[index].insert(key, variant);
        Ok(key)
    }

    pub(super) fn bench<'a>(&'a self, gpu: &'a Gpu) -> Bench<'a> {
        Bench {
            gpu,
            plan: &self.plan,
            pool: &self.pool,
            uniforms: &self.uniforms,
            fixed: &self.fixed,
            rotation: &self.rotation,
            materials: &self.materials,
            by_faces: &self.by_faces,
        }
    }

    /// One number for the rotations of all rings that a pass touches.
    pub(super) fn rotation_key(&self, index: usize) -> usize {
        self.rings_of[index]
            .iter()
            .fold(0, |key, ring| key * self.plan.rings[*ring].objects.len() + self.rotation[*ring])
    }

    fn turn(&mut self, info: &StepInfo) {
        self.done[info.steps] += 1;
        for (ring, rotation) in self.plan.rings.iter().zip(&mut self.rotation) {
            if ring.steps == info.steps && !ring.objects.is_empty() {
                *rotation = (*rotation + ring.turn) % ring.objects.len();
            }
        }
    }

    /// Forgets what was made with the memory that an object had.
    pub(super) fn forget_variants(&mut self, object: usize) {
        let handle = self.pool.handle(object);
        for (pass, variants) in self.plan.passes.iter().zip(&mut self.variants) {
            let touches =
                |r: ObjectRef| super::pool::candidates(&self.plan, r).iter().any(|id| self.pool.handle(*id) == handle);
            if references(pass).into_iter().any(touches) {
                variants.clear();
            }
        }
    }
}

/// A pass's, by key of [`Runner::rotation_key`]: most have one, which lies here.
#[derive(Debug, Default)]
pub(super) struct Variants {
    first: Option<(usize, Variant)>,
    others: BTreeMap<usize, Variant>,
}

impl Variants {
    pub fn get(&self, key: usize) -> Option<&Variant> {
        match &self.first {
            Some((known, variant)) if *known == key => Some(variant),
            Some(_) => self.others.get(&key),
            None => None,
        }
    }

    fn insert(&mut self, key: usize, variant: Variant) {
        match &mut self.first {
            Some((known, _)) if *known != key => _ = self.others.insert(key, variant),
            first => *first = Some((key, variant)),
        }
    }

    pub fn clear(&mut self) {
        self.first = None;
        self.others.clear();
    }
}

fn clear_words(encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer, words: &Range<u64>) {
    if !words.is_empty() {
        encoder.clear_buffer(buffer, words.start * 4, Some((words.end - words.start) * 4));
    }
}

/// How many runs of passes a frame has, at most.
fn runs(plan: &Plan, steps: &[StepInfo]) -> u32 {
    let inside: usize = steps.iter().map(|info| plan.steps[info.steps].passes.len()).sum();
    u32::try_from(plan.passes.len() + inside).unwrap_or(u32::MAX / 4)
}

fn own_value(frame: &Frame<'_>, name: &str, step: Option<&StepInfo>) -> Option<Value> {
    match name {
        "time" => Some(Value::Float(step.map_or(frame.time, |s| s.time))),
        "delta" => Some(Value::Float(step.map_or(frame.delta, |s| s.delta))),
        "frame" => i64::try_from(frame.frame).ok().map(Value::Int),
        "step" => step.and_then(|s| i64::try_from(s.step).ok()).map(Value::Int),
        _ => None,
    }
}
