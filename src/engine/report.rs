//! What a frame did, as plain data.

use std::collections::BTreeMap;

use crate::plan::changes::Reason;

/// What a frame did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// The frame's number as its [`super::Frame`] gave it.
    pub frame: u64,
    /// Passes that ran, in program order.
    pub passes: Vec<PassReport>,
    /// Passes that the plan has: those that did not run were skipped.
    pub passes_planned: usize,
    /// CPU time of a frame up to its submission, in milliseconds.
    pub encode_ms: f64,
    /// CPU time of submitting, in milliseconds.
    pub submit_ms: f64,
    /// Passes of wgpu's that were begun: passes that follow each other share them.
    pub compute_passes: u32,
    pub render_passes: u32,
    pub submissions: u32,
    /// Bytes that went to the device since the frame before: uniforms, and what was uploaded.
    pub uploaded_bytes: u64,
    /// Counted buffers that were settled. Empty until the GPU's answer is there.
    pub counts: Vec<CountReport>,
    /// What each of the plan's units did, and why. Empty if the plan says nothing of units.
    pub units: Vec<UnitReport>,
    /// Whether the GPU's answer (times, counts) is in it.
    pub complete: bool,
}

/// Whether passes that run or are skipped together ran.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitReport {
    pub ran: bool,
    /// Why it ran; empty if it was skipped, since nothing that it depends on has changed.
    pub why: Vec<Reason>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct PassReport {
    /// Instance path.
    pub path: String,
    /// Which of the report's units it belongs to: that says why it ran.
    pub unit: usize,
    /// How often it ran in the frame: more than once inside `Steps`.
    pub runs: u32,
    /// GPU time of all its runs in milliseconds, where the device can tell.
    pub gpu_ms: Option<f64>,
    /// The pass whose time holds this one's: they share a pass of wgpu's, and the device tells
    /// no time inside of it.
    pub timed_with: Option<String>,
    /// CPU time of recording all its runs in milliseconds, if times were asked for. Of draws that
    /// share a render pass the first has it all. What wgpu does when the frame's commands are
    /// finished is in the frame's time only.
    pub record_ms: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CountReport {
    /// Instance path of the counted buffer.
    pub path: String,
    /// How many were appended, the most of all runs in the frame.
    pub raw: u32,
    pub capacity: u64,
    /// Whether it was appended to inside `Steps`, where it cannot grow.
    pub in_steps: bool,
}

impl CountReport {
    pub fn overflowed(&self) -> bool {
        u64::from(self.raw) > self.capacity
    }
}

impl Report {
    /// Counted buffers that had too little room.
    pub fn overflows(&self) -> impl Iterator<Item = &CountReport> {
        self.counts.iter().filter(|c| c.overflowed())
    }

    /// GPU time of all passes in milliseconds, where the device can tell.
    pub fn gpu_ms(&self) -> Option<f64> {
        self.passes.iter().filter(|p| p.timed_with.is_none()).map(|p| p.gpu_ms).sum()
    }
}

/// What a preparation made and what it found made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BuildReport {
    pub pipelines_built: usize,
    pub pipelines_reused: usize,
    /// Draws that share the render pass of the one before them.
    pub draws_joined: usize,
    /// Bytes of textures and buffers that the runner holds. Inputs count from their first use.
    pub memory_bytes: u64,
    /// Of each `Steps`, whether its state went on from the runner before.
    pub state_kept: BTreeMap<String, bool>,
}
