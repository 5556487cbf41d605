//! GPU times and counts: written during a frame, read back later without a stall.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Instant;

use super::bind::stat_of;
use super::encode::Begun;
use super::gpu::Gpu;
use super::report::{CountReport, PassReport, Report, UnitReport};
use crate::plan::changes::{Changes, Decision};
use crate::plan::model::{ObjectKind, Origin, Pass, PassKind, Plan};

/// Frames whose answers may be on their way at once.
const IN_FLIGHT: usize = 3;
/// Runs of passes that are timed in a frame: wgpu allows 4,096 queries to a set.
const MOST_PAIRS: u32 = 2048;

const FREE: u8 = 0;
const WAITING: u8 = 1;
const READY: u8 = 2;
const FAILED: u8 = 3;

/// An answer on its way. Commands that nobody submits take it with them.
struct Answer(Arc<AtomicU8>);

impl Answer {
    fn came(&self, is_there: bool) {
        self.0.store(if is_there { READY } else { FAILED }, Ordering::Release);
    }
}

impl Drop for Answer {
    fn drop(&mut self) {
        // What came stays as it is.
        _ = self.0.compare_exchange(WAITING, FAILED, Ordering::AcqRel, Ordering::Acquire);
    }
}

#[derive(Debug)]
struct Slot {
    buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
    frame: Frame,
}

/// What has to be known of a frame to read its answer.
#[derive(Debug, Default)]
struct Frame {
    number: u64,
    sequence: u64,
    /// With submitting.
    encode_ms: f64,
    begun: Begun,
    uploaded_bytes: u64,
    /// The pass of each pair of queries.
    marks: Vec<usize>,
    /// Passes whose time is in that of another, which began what they share.
    with: Vec<(usize, usize)>,
    /// How often each pass ran.
    runs: Vec<u32>,
    /// Milliseconds of recording each pass; of draws that share a render pass, the first has all.
    record_ms: Vec<f64>,
    /// Which units ran, and why.
    decision: Decision,
}

impl Frame {
    /// Takes over another's, into memory that is there.
    fn copy_from(&mut self, other: &Self) {
        let Self { number, sequence, encode_ms, begun, uploaded_bytes, marks, with, runs, record_ms, decision } = other;
        (self.number, self.sequence) = (*number, *sequence);
        (self.encode_ms, self.begun, self.uploaded_bytes) = (*encode_ms, *begun, *uploaded_bytes);
        self.marks.clone_from(marks);
        self.with.clone_from(with);
        self.runs.clone_from(runs);
        self.record_ms.clone_from(record_ms);
        self.decision.clone_from(decision);
    }
}

/// The newest answer, as the device gave it.
#[derive(Debug, Default)]
struct Answered {
    /// Whether nobody took it yet.
    is_new: bool,
    frame: Frame,
    bytes: Vec<u8>,
}

/// Where the current frame's answer goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Captured {
    /// Nowhere: all slots are on their way.
    No,
    Slot(usize),
    /// The device has nothing to say: no times are wanted and nothing is counted.
    Known,
}

#[derive(Debug)]
pub(super) struct Timing {
    queries: Option<wgpu::QuerySet>,
    resolved: Option<wgpu::Buffer>,
    pairs: u32,
    in_encoders: bool,
    /// Whether the device tells time inside of wgpu's passes. Where it does not, passes that
    /// share one have one time.
    in_passes: bool,
    /// Whether anybody wants times.
    wanted: bool,
    /// Nanoseconds to a tick.
    period: f32,
    stats_bytes: u64,
    slots: Vec<Slot>,
    now: Frame,
    captured: Captured,
    /// Bytes that had gone to the device at the frame before.
    uploaded: u64,
    latest: Answered,
}

impl Timing {
    pub fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let features = gpu.features();
        let settles = stat_of(plan, plan.passes.len());
        let mut timing = Self {
            queries: None,
            resolved: None,
            pairs: 0,
            in_encoders: features.contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS),
            in_passes: features.contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES),
            wanted: true,
            period: gpu.queue().get_timestamp_period(),
            stats_bytes: settles as u64 * 4,
            slots: Vec::new(),
            now: Frame::default(),
            captured: Captured::No,
            uploaded: gpu.uploaded_bytes(),
            latest: Answered::default(),
        };
        timing.grow(gpu, plan.passes.len() as u32);
        timing
    }

    /// Makes room for so many runs of passes.
    fn grow(&mut self, gpu: &Gpu, runs: u32) {
        let timed = gpu.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let pairs = if timed { runs.next_power_of_two().clamp(16, MOST_PAIRS) } else { 0 };
        if pairs <= self.pairs && !self.slots.is_empty() {
            return;
        }
        let buffer = |label, size, usage| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        if pairs > 0 {
            self.queries = Some(gpu.device().create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("times"),
                ty: wgpu::QueryType::Timestamp,
                count: pairs * 2,
            }));
            let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
            self.resolved = Some(buffer("times", u64::from(pairs) * 16, usage));
        }
        self.pairs = pairs;
        let bytes = u64::from(pairs) * 16 + self.stats_bytes;
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        self.slots = (0..IN_FLIGHT)
            .map(|_| Slot {
                buffer: buffer("answers", bytes.max(4), usage),
                state: Arc::new(AtomicU8::new(FREE)),
                frame: Frame::default(),
            })
            .collect();
    }

    /// Begins a frame that will run passes so many times.
    pub fn begin(&mut self, gpu: &Gpu, plan: &Plan, number: u64, runs: u32) {
        self.grow(gpu, runs);
        self.now.number = number;
        self.now.sequence += 1;
        self.now.marks.clear();
        self.now.with.clear();
        self.now.runs.clear();
        self.now.runs.resize(plan.passes.len(), 0);
        self.now.record_ms.clear();
        if self.wanted {
            self.now.record_ms.resize(plan.passes.len(), 0.0);
        }
        self.now.begun = Begun::default();
        self.captured = Captured::No;
    }

    pub fn turn(&mut self, on: bool) {
        self.wanted = on;
    }

    /// Notes that a pass runs, and gives it a pair of queries if it is to be timed and there
    /// are any left. `joins` says that it shares a pass of wgpu's with the one before it.
    pub fn mark(&mut self, pass: usize, timed: bool, joins: bool) -> Option<u32> {
        self.now.runs[pass] += 1;
        let pair = self.now.marks.len() as u32;
        if !timed || !self.wanted || self.pairs == 0 {
            return None;
        }
        if joins && !self.in_passes {
            let leader = self.now.marks.last().copied();
            self.now.with.extend(leader.filter(|leader| *leader != pass).map(|leader| (pass, leader)));
            return None;
        }
        if pair >= self.pairs {
            return None;
        }
        self.now.marks.push(pass);
        Some(pair)
    }

    /// When recording a pass began, if anybody wants times.
    pub fn clock(&self) -> Option<Instant> {
        self.wanted.then(Instant::now)
    }

    /// Notes how long recording took that began then.
    pub fn recorded(&mut self, pass: usize, began: Option<Instant>) {
        if let (Some(began), Some(spent)) = (began, self.now.record_ms.get_mut(pass)) {
            *spent += began.elapsed().as_secs_f64() * 1e3;
        }
    }

    /// For a render pass that is one of those that make up a pass.
    pub fn render(&self, pair: Option<u32>, first: bool, last: bool) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.render_from_to(first.then_some(pair?), last.then_some(pair?))
    }

    /// For a render pass of so many draws, the first of which has this pair.
    pub fn render_of(&self, pair: Option<u32>, draws: usize) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.render_from_to(pair, self.nth(pair, if self.in_passes { draws.saturating_sub(1) } else { 0 }))
    }

    fn render_from_to(&self, from: Option<u32>, to: Option<u32>) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        if from.is_none() && to.is_none() {
            return None;
        }
        Some(wgpu::RenderPassTimestampWrites {
            query_set: self.queries.as_ref()?,
            beginning_of_pass_write_index: from.map(|pair| pair * 2),
            end_of_pass_write_index: to.map(|pair| pair * 2 + 1),
        })
    }

    /// The pair of the nth of draws that share a render pass: they were marked one after the other.
    fn nth(&self, first: Option<u32>, nth: usize) -> Option<u32> {
        let marked = (self.now.marks.len() as u32).checked_sub(1)?;
        first.map(|first| (first + nth as u32).min(marked))
    }

    /// Ends the time of one draw and begins that of the next.
    pub fn write_between_draws(&self, render: &mut wgpu::RenderPass<'_>, first: Option<u32>, nth: usize) {
        if nth == 0 || !self.in_passes {
            return;
        }
        let (before, now) = (self.nth(first, nth - 1), self.nth(first, nth));
        if let (Some(before), Some(now), Some(queries)) = (before, now, &self.queries)
            && before != now
        {
            render.write_timestamp(queries, before * 2 + 1);
            render.write_timestamp(queries, now * 2);
        }
    }

    /// For a compute pass that begins with dispatches of this pair, where the device tells no
    /// time inside of it.
    pub fn compute(&self, pair: Option<u32>) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let pair = pair.filter(|_| !self.in_passes)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: self.queries.as_ref()?,
            beginning_of_pass_write_index: Some(pair * 2),
            end_of_pass_write_index: Some(pair * 2 + 1),
        })
    }

    /// Writes the begin (0) or end (1) of a pair inside a compute pass, where the device can.
    pub fn write_in_compute(&self, compute: &mut wgpu::ComputePass<'_>, pair: Option<u32>, end: u32) {
        if let (Some(pair), Some(queries), true) = (pair, &self.queries, self.in_passes) {
            compute.write_timestamp(queries, pair * 2 + end);
        }
    }

    /// Whether what is no pass can be timed.
    pub fn times_encoders(&self) -> bool {
        self.in_encoders
    }

    /// Writes the begin (0) or end (1) of a pair between passes.
    pub fn write(&self, encoder: &mut wgpu::CommandEncoder, pair: Option<u32>, end: u32) {
        if let (Some(pair), Some(queries)) = (pair, &self.queries) {
            encoder.write_timestamp(queries, pair * 2 + end);
        }
    }

    /// Whether the device has an answer to give for the current frame.
    pub fn has_questions(&self) -> bool {
        !self.now.marks.is_empty() || self.stats_bytes > 0
    }

    /// Notes that all there is to know of the current frame is known here.
    pub fn know(&mut self) {
        self.captured = Captured::Known;
    }

    /// Copies times and counts to a buffer that can be read, if one is free.
    pub fn capture(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, stats: &wgpu::Buffer) {
        if self.slots.iter().all(|s| s.state.load(Ordering::Acquire) != FREE) {
            gpu.poll();
            self.collect();
        }
        let Some(at) = self.slots.iter().position(|s| s.state.load(Ordering::Acquire) == FREE) else { return };
        let marks = self.now.marks.len() as u64;
        let target = &self.slots[at].buffer;
        if let (Some(queries), Some(resolved)) = (&self.queries, &self.resolved)
            && marks > 0
        {
            encoder.resolve_query_set(queries, 0..marks as u32 * 2, resolved, 0);
            encoder.copy_buffer_to_buffer(resolved, 0, target, 0, marks * 16);
        }
        if self.stats_bytes > 0 {
            encoder.copy_buffer_to_buffer(stats, 0, target, u64::from(self.pairs) * 16, self.stats_bytes);
        }
        let slot = &mut self.slots[at];
        slot.frame.copy_from(&self.now);
        slot.state.store(WAITING, Ordering::Release);
        let answer = Answer(Arc::clone(&slot.state));
        encoder.map_buffer_on_submit(&slot.buffer, wgpu::MapMode::Read, .., move |mapped| answer.came(mapped.is_ok()));
        self.captured = Captured::Slot(at);
    }

    /// Whether nothing ran in the current frame.
    pub fn is_idle(&self) -> bool {
        self.now.runs.iter().all(|runs| *runs == 0)
    }

    pub fn is_captured(&self) -> bool {
        self.captured != Captured::No
    }

    /// Notes how many bytes have gone to the device up to now.
    pub fn uploaded(&mut self, bytes: u64) {
        self.now.uploaded_bytes = bytes - self.uploaded;
        self.uploaded = bytes;
    }

    /// Notes what was submitted.
    pub fn handed_over(&mut self, begun: Begun) {
        self.now.begun = begun;
    }

    /// Notes how long the frame took on the CPU, also for the answer that is on its way.
    pub fn submitted(&mut self, encode_ms: f64) {
        self.now.encode_ms = encode_ms;
        match self.captured {
            Captured::No => {}
            Captured::Slot(at) => self.slots[at].frame.copy_from(&self.now),
            Captured::Known => {
                self.latest.is_new = true;
                self.latest.frame.copy_from(&self.now);
                self.latest.bytes.clear();
            }
        }
    }

    /// Keeps the newest of the answers that have come.
    pub fn collect(&mut self) {
        for slot in &self.slots {
            match slot.state.load(Ordering::Acquire) {
                READY => {
                    if let Ok(view) = slot.buffer.get_mapped_range(..)
                        && self.latest.frame.sequence < slot.frame.sequence
                    {
                        self.latest.is_new = true;
                        self.latest.frame.copy_from(&slot.frame);
                        self.latest.bytes.clear();
                        self.latest.bytes.extend_from_slice(&view);
                    }
                    slot.buffer.unmap();
                    slot.state.store(FREE, Ordering::Release);
                }
                FAILED => slot.state.store(FREE, Ordering::Release),
                _ => {}
            }
        }
    }

    /// The newest complete report, once.
    pub fn take(&mut self, plan: &Plan, changes: &Changes) -> Option<Report> {
        if !std::mem::take(&mut self.latest.is_new) {
            return None;
        }
        let mut report = self.read(plan, &self.latest.frame, &self.latest.bytes);
        report.units = units(changes, &self.latest.frame.decision);
        Some(report)
    }

    /// What is known of the current frame before the GPU answers.
    pub fn preliminary(&self, plan: &Plan, changes: &Changes) -> Report {
        Report { units: units(changes, &self.now.decision), ..report(plan, &self.now) }
    }

    /// Notes which units run in the current frame.
    pub fn decided(&mut self, decision: &Decision) {
        self.now.decision.clone_from(decision);
    }

    fn read(&self, plan: &Plan, frame: &Frame, bytes: &[u8]) -> Report {
        let mut report = report(plan, frame);
        report.complete = true;
        // The answer may be older than the room that there is for times by now.
        let (times, stats) = bytes.split_at(bytes.len().saturating_sub(self.stats_bytes as usize));
        let mut spent: Vec<Option<f64>> = vec![None; plan.passes.len()];
        for (pair, pass) in times.chunks_exact(16).zip(&frame.marks) {
            let ticks = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| pair[at + i]));
            let ms = ticks(8).saturating_sub(ticks(0)) as f64 * f64::from(self.period) * 1e-6;
            *spent[*pass].get_or_insert(0.0) += ms;
        }
        let ran = (0..plan.passes.len()).filter(|p| frame.runs[*p] > 0);
        for (pass, index) in report.passes.iter_mut().zip(ran) {
            pass.gpu_ms = spent[index];
            let with = frame.with.iter().find(|(pass, _)| *pass == index);
            pass.timed_with = with.map(|(_, leader)| plan.passes[*leader].path.clone());
        }
        report.counts = counts(plan, frame, stats);
        report
    }
}

fn report(plan: &Plan, frame: &Frame) -> Report {
    let ran = plan.passes.iter().enumerate().filter(|(index, _)| frame.runs.get(*index).is_some_and(|runs| *runs > 0));
    let pass = |(index, pass): (usize, &Pass)| PassReport {
        path: pass.path.clone(),
        unit: pass.unit,
        runs: frame.runs[index],
        gpu_ms: None,
        timed_with: None,
        record_ms: frame.record_ms.get(index).copied(),
    };
    Report {
        frame: frame.number,
        passes: ran.map(pass).collect(),
        passes_planned: plan.passes.len(),
        encode_ms: (frame.encode_ms - frame.begun.submit_ms).max(0.0),
        submit_ms: frame.begun.submit_ms,
        compute_passes: frame.begun.compute_passes,
        render_passes: frame.begun.render_passes,
        submissions: frame.begun.submissions,
        uploaded_bytes: frame.uploaded_bytes,
        counts: Vec::new(),
        units: Vec::new(),
        complete: false,
    }
}

fn units(changes: &Changes, decision: &Decision) -> Vec<UnitReport> {
    let unit = |unit| UnitReport { ran: decision.runs(unit) == Some(true), why: changes.why(decision, unit) };
    (0..decision.len()).map(unit).collect()
}

/// One entry for each counted buffer, with the most that any of its settling passes saw.
fn counts(plan: &Plan, frame: &Frame, stats: &[u8]) -> Vec<CountReport> {
    let mut found: Vec<CountReport> = Vec::new();
    let settles = plan.passes.iter().enumerate().filter_map(|(index, pass)| match &pass.kind {
        PassKind::Settle { counted, .. } => Some((index, pass, *counted)),
        _ => None,
    });
    for ((index, pass, counted), word) in settles.zip(stats.chunks_exact(4)) {
        // Outside of steps, what a settling pass counted is there until it runs again.
        if frame.runs[index] == 0 && pass.steps.is_some() {
            continue;
        }
        let raw = u32::from_le_bytes(std::array::from_fn(|i| word[i]));
        let Some(id) = super::pool::candidates(plan, counted).first().copied() else { continue };
        let object = &plan.objects[id];
        let ObjectKind::Buffer(buffer) = &object.kind else { continue };
        match found.iter_mut().find(|c| c.path == object.path) {
            Some(known) => known.raw = known.raw.max(raw),
            None => found.push(CountReport {
                path: object.path.clone(),
                raw,
                capacity: buffer.items,
                // What steps fill may be settled first where it is read behind them.
                in_steps: pass.steps.is_some() || matches!(object.origin, Origin::State(_)),
            }),
        }
    }
    found
}
