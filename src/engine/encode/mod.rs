//! Commands for each kind of pass.

mod arguments;
mod clear;
mod compute;
mod copy;
pub(super) mod draw;
mod group;
mod mips;
mod recorder;

pub(super) use recorder::{Begun, Recorder};

use super::bind::{Fixed, Variant, resolve};
use super::clear::ClearVariant;
use super::mips::MipInto;
use super::pipeline::{Pipeline, PipelineKind};
use super::pool::Pool;
use super::timing::Timing;
use crate::plan::model::{ObjectId, ObjectRef, Pass, PassKind, Plan};

/// A frame on its way into commands.
pub(super) struct Encoding<'a, 'b> {
    pub recorder: &'a mut Recorder<'b>,
    pub plan: &'a Plan,
    pub pool: &'a Pool,
    pub fixed: &'a Fixed,
    pub rotation: &'a [usize],
    pub timing: &'a Timing,
    /// The pair of queries that times the pass.
    pub pair: Option<u32>,
}

impl Encoding<'_, '_> {
    /// Encodes one pass.
    pub fn pass(&mut self, pass: &Pass, pipeline: Option<&Pipeline>, variant: &Variant) {
        // Of most passes the variants know all: the plan is not looked at.
        match variant {
            Variant::Dispatch(variant) => return compute::encode(self, pass, variant),
            Variant::Draw(variant) => return draw::encode(self, std::iter::once(draw::Part { pass, variant })),
            _ => {}
        }
        match (&pass.kind, variant) {
            (PassKind::Clear { view, .. }, Variant::Clear(variant)) => {
                clear::encode(self, pass, view, pipeline, variant);
            }
            (PassKind::Mips { .. }, Variant::Mips(steps)) => mips::encode(self, pass, pipeline, steps),
            (PassKind::Copy { from, to }, _) => copy::encode(self, pass, from, to),
            (PassKind::Arguments { from, offset, indexed, slot }, _) => {
                arguments::encode(self, pass, *from, *offset, *indexed, *slot);
            }
            // Variants are made from the same kinds.
            _ => debug_assert!(false, "a variant of another kind"),
        }
    }

    pub fn object(&self, object: ObjectRef) -> ObjectId {
        resolve(self.plan, self.rotation, object)
    }

    /// Encodes what is no pass, in a debug group of the pass's name.
    fn between(&mut self, pass: &Pass, commands: impl FnOnce(&mut wgpu::CommandEncoder)) {
        let (timing, pair, named) = (self.timing, self.pair, self.recorder.named);
        let encoder = self.recorder.encoder();
        if named {
            encoder.push_debug_group(&pass.path);
        }
        timing.write(encoder, pair, 0);
        commands(encoder);
        timing.write(encoder, pair, 1);
        if named {
            encoder.pop_debug_group();
        }
    }

    /// Encodes dispatches, in the compute pass that is open or in a new one. `first` and `last`
    /// say whether the pass's time begins and ends with them.
    fn dispatches(
        &mut self,
        pass: &Pass,
        (first, last): (bool, bool),
        commands: impl FnOnce(&mut wgpu::ComputePass<'static>),
    ) {
        let (timing, pair, named) = (self.timing, self.pair, self.recorder.named);
        let compute = self
            .recorder
            .compute(&wgpu::ComputePassDescriptor { label: Some(&pass.path), timestamp_writes: timing.compute(pair) });
        if named {
            compute.push_debug_group(&pass.path);
        }
        timing.write_in_compute(compute, pair.filter(|_| first), 0);
        commands(compute);
        timing.write_in_compute(compute, pair.filter(|_| last), 1);
        if named {
            compute.pop_debug_group();
        }
    }
}

/// Whether the commands of a pass can carry times: they need a pass of wgpu, or a device that
/// tells time between them.
pub(super) fn can_be_timed(variant: &Variant, between: bool) -> bool {
    match variant {
        Variant::Nothing | Variant::Clear(ClearVariant::Texels { .. } | ClearVariant::Zero { .. }) => between,
        Variant::Clear(ClearVariant::Color { views, .. } | ClearVariant::Depth { views, .. }) => !views.is_empty(),
        Variant::Mips(steps) => !steps.is_empty(),
        Variant::Dispatch(_) | Variant::Draw(_) => true,
        Variant::Clear(ClearVariant::Words { .. }) => true,
    }
}

/// Whether a pass is nothing but dispatches, which join those before them.
pub(super) fn is_dispatch(variant: &Variant) -> bool {
    match variant {
        Variant::Dispatch(_) | Variant::Clear(ClearVariant::Words { .. }) => true,
        Variant::Mips(steps) => matches!(steps.first().map(|step| &step.into), Some(MipInto::Groups(_))),
        _ => false,
    }
}

fn compute_pipeline(pipeline: Option<&Pipeline>) -> Option<&wgpu::ComputePipeline> {
    match &pipeline?.kind {
        PipelineKind::Compute(pipeline) => Some(pipeline),
        PipelineKind::Draw(_) => None,
    }
}

fn render_pipeline(pipeline: Option<&Pipeline>) -> Option<&wgpu::RenderPipeline> {
    match &pipeline?.kind {
        PipelineKind::Draw(pipeline) => Some(pipeline),
        PipelineKind::Compute(_) => None,
    }
}
