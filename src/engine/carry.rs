//! What goes over from the runner before: which contents, versions and arguments are still good,
//! and so which units need not run again.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

use super::bind::Fixed;
use super::errors;
use super::gpu::Gpu;
use super::pool::{Pool, candidates};
use super::prepare::Runner;
use super::report::Report;
use crate::diagnostic::Diagnostic;
use crate::plan::changes::Changes;
use crate::plan::model::{ObjectId, Origin, Pass, PassKind, Plan};

/// Whose content an object has, for those that are not made by the runner's own passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Content {
    /// Uploaded, or nobody's yet.
    #[default]
    Own,
    /// Somebody else's, at this version.
    Version(u64),
    /// Somebody else's, who does not tell when it changes: it counts as changed in every frame.
    Unversioned,
}

/// A number that no content had before, in any runner.
pub(super) fn new_stamp() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// What a new runner knows of its objects.
#[derive(Debug)]
pub(super) struct Carried {
    pub changes: Changes,
    pub sources: Vec<Content>,
    pub stamps: Vec<u64>,
}

/// Which objects of a plan have, in its pool, what they had in the runner before.
fn kept(plan: &Plan, pool: &Pool, before: &Runner) -> Vec<Option<ObjectId>> {
    let old: HashMap<&str, ObjectId> = before.plan.objects.iter().enumerate().map(|(id, o)| (&*o.path, id)).collect();
    let of = |id: ObjectId| {
        let object = &plan.objects[id];
        let was = *old.get(object.path.as_str())?;
        let same_origin =
            std::mem::discriminant(&object.origin) == std::mem::discriminant(&before.plan.objects[was].origin);
        let same_memory = pool.memory(id).is_some() && pool.memory(id) == before.pool.memory(was);
        (same_origin && same_memory && !before.pool.shares(was)).then_some(was)
    };
    (0..plan.objects.len()).map(of).collect()
}

/// What is still good of the runner before.
pub(super) fn carry(plan: &Plan, pool: &Pool, previous: Option<&Runner>) -> Carried {
    let shares = |id: ObjectId| pool.shares(id);
    let mut changes = Changes::new(plan, &shares);
    let mut sources = vec![Content::Own; plan.objects.len()];
    let mut stamps: Vec<u64> = plan.objects.iter().map(|_| new_stamp()).collect();
    if let Some(before) = previous {
        let kept = kept(plan, pool, before);
        for (id, was) in kept.iter().enumerate() {
            if let Some(was) = *was {
                sources[id] = before.sources[was];
                stamps[id] = before.stamps[was];
            }
        }
        changes.carry(plan, (&before.plan, &before.changes), &|id| kept[id].is_some(), &shares);
    }
    Carried { changes, sources, stamps }
}

/// Copies the arguments and counts that the engine's kernels wrote to their new places: who is
/// skipped from now on still needs them.
fn copy_answers(encoder: &mut wgpu::CommandEncoder, plan: &Plan, fixed: &Fixed, before: &Runner) -> bool {
    let slots = slots(&before.plan);
    let stats = stats(&before.plan);
    let mut any = false;
    for (path, slot) in self::slots(plan) {
        if let Some(was) = slots.get(path) {
            let [from, to] = [*was, slot].map(|slot| u64::from(slot) * 32);
            encoder.copy_buffer_to_buffer(&before.fixed.arguments, from, &fixed.arguments, to, 32);
            any = true;
        }
    }
    for (settle, stat) in self::stats(plan) {
        if let Some(was) = stats.get(&settle) {
            encoder.copy_buffer_to_buffer(&before.fixed.stats, *was * 4, &fixed.stats, stat * 4, 4);
            any = true;
        }
    }
    any
}

/// The slot of each pass whose arguments come from a count or a shader.
fn slots(plan: &Plan) -> HashMap<&str, u32> {
    plan.passes.iter().filter_map(|pass| Some((pass.path.as_str(), pass.kind.slot()?))).collect()
}

/// The place of each settling pass's raw count. One buffer may be settled more than once.
fn stats(plan: &Plan) -> HashMap<(&str, usize), u64> {
    let mut stats = HashMap::new();
    let mut settled: HashMap<&str, usize> = HashMap::new();
    for pass in plan.passes.iter().filter(|pass| matches!(pass.kind, PassKind::Settle { .. })) {
        let times = settled.entry(&pass.path).or_default();
        stats.insert((pass.path.as_str(), *times), stats.len() as u64);
        *times += 1;
    }
    stats
}

/// What is last known of counts, for a frame in which nothing has to run.
pub(super) fn last_report(plan: &Plan, before: &Runner) -> Option<Report> {
    let counted = |pass: &Pass| match &pass.kind {
        PassKind::Settle { counted, .. } => {
            candidates(plan, *counted).first().map(|id| plan.objects[*id].path.as_str())
        }
        _ => None,
    };
    let mut last = before.last.clone()?;
    last.counts.retain(|count| plan.passes.iter().filter_map(counted).any(|path| path == count.path));
    Some(last)
}

impl Runner {
    /// Gives those who are skipped from now on what the engine's kernels wrote for them under the plan before, and
    /// those who are new the arguments that follow from counts which are there.
    pub(super) fn take_answers(&self, gpu: &Gpu, before: &Runner) -> Result<(), Diagnostic> {
        let label = Some("carried over");
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        let mut any = copy_answers(&mut encoder, &self.plan, &self.fixed, before);
        for index in self.changes.unanswered() {
            let pass = &self.plan.passes[*index];
            let variant =
                errors::scoped(gpu, || self.bench(gpu).settled_again(*index, self.pipelines[*index].as_deref()))
                    .and_then(|made| made)
                    .map_err(|e| errors::refused("what is bound to", &pass.path, pass.span, &e))?;
            let mut compute =
                encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes: None });
            compute.set_pipeline(&variant.pipeline);
            compute.set_bind_group(0, variant.group.as_ref(), &[]);
            compute.dispatch_workgroups(1, 1, 1);
            any = true;
        }
        if any {
            gpu.queue().submit([encoder.finish()]);
        }
        Ok(())
    }

    /// Tells the changes what the frame to come has: values of its own, and resources whose
    /// owners do not say when they change.
    pub(super) fn notice(&mut self, live: &dyn Fn(&str) -> Option<crate::graph::value::Value>) {
        for at in 0..self.changes.live_count() {
            let value = self.changes.live_name(at).and_then(live);
            if self.changes.note_live(at, value) {
                self.uniforms.note_change();
            }
        }
        for (object, source) in self.plan.objects.iter().zip(&self.sources) {
            if *source == Content::Unversioned
                && let Some(input) = object.origin.input()
            {
                self.changes.note_input(input);
            }
        }
    }

    /// An object that comes from outside has another content than before.
    pub(super) fn note_content(&mut self, object: ObjectId, source: Content) {
        self.stamps[object] = new_stamp();
        self.sources[object] = source;
        match &self.plan.objects[object].origin {
            Origin::Input(input) | Origin::Attribute { input, .. } | Origin::Mesh { input, .. } => {
                self.changes.note_input(input);
            }
            // Somebody wrote over what passes made.
            Origin::Frame | Origin::State(_) => self.changes.note_lost(),
        }
    }

    /// Gives what the passes that ran have written new stamps.
    pub(super) fn stamp(&mut self) {
        let stamp = new_stamp();
        for (object, unit) in &self.writers {
            if self.changes.runs(*unit) {
                self.stamps[*object] = stamp;
            }
        }
    }
}

/// Each object that passes write, with the unit that does.
pub(super) fn writers(plan: &Plan) -> Vec<(ObjectId, usize)> {
    let written = plan.passes.iter().flat_map(|pass| pass.accesses.iter().filter(|a| a.write).map(|a| (pass.unit, a)));
    let mut writers: Vec<(ObjectId, usize)> = written
        .flat_map(|(unit, access)| candidates(plan, access.object).into_iter().map(move |id| (id, unit)))
        .collect();
    writers.sort_unstable();
    writers.dedup();
    writers
}
