//! From the list of passes to commands: which are encoded together, and how each is timed.

use std::ops::Range;

use super::{Encoding, Recorder, can_be_timed, draw};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::engine::bind::Variant;
use crate::engine::errors;
use crate::engine::gpu::Gpu;
use crate::engine::prepare::Runner;

impl Runner {
    /// Encodes those passes of a range that are wanted; `None` wants all.
    ///
    /// # Errors
    /// If the device refuses what a pass binds.
    pub(in crate::engine) fn encode_range(
        &mut self,
        gpu: &Gpu,
        only: Option<&[bool]>,
        recorder: &mut Recorder<'_>,
        range: Range<usize>,
    ) -> Result<(), Diagnostic> {
        let mut at = range.start;
        while at < range.end {
            let end = (at + 1..range.end).find(|p| self.leaders[*p] != self.leaders[at]).unwrap_or(range.end);
            self.encode_group(gpu, only, recorder, at..end)?;
            at = end;
        }
        Ok(())
    }

    /// Encodes a pass, or draws that share a render pass.
    fn encode_group(
        &mut self,
        gpu: &Gpu,
        only: Option<&[bool]>,
        recorder: &mut Recorder<'_>,
        group: Range<usize>,
    ) -> Result<(), Diagnostic> {
        let is_wanted = |index: &usize| only.is_none_or(|only| only.get(*index) != Some(&false));
        let mut passes = 0;
        let mut only_one = None;
        for index in group.clone().filter(is_wanted) {
            let key = self.ensure_variant(gpu, index)?;
            passes += 1;
            only_one = Some((index, key));
        }
        if let Some((index, key)) = only_one.filter(|_| passes == 1) {
            self.encode_one(recorder, index, key);
        } else if passes > 1 {
            self.encode_draws(recorder, group.filter(is_wanted));
        }
        recorder.count(gpu, passes);
        Ok(())
    }

    fn encode_one(&mut self, recorder: &mut Recorder<'_>, index: usize, key: usize) {
        let Some(variant) = self.variants[index].get(key) else { return };
        let is_timed = can_be_timed(variant, self.timing.times_encoders());
        let joins = recorder.is_computing() && super::is_dispatch(variant);
        let pair = self.timing.mark(index, is_timed, joins);
        let began = self.timing.clock();
        self.record(recorder, index, key, pair);
        self.timing.recorded(index, began);
    }

    fn encode_draws(&mut self, recorder: &mut Recorder<'_>, group: impl Iterator<Item = usize> + Clone) {
        let mut first = None;
        for (nth, index) in group.clone().enumerate() {
            let pair = self.timing.mark(index, true, nth > 0);
            first = first.or(pair);
        }
        let (leader, began) = (group.clone().next(), self.timing.clock());
        let mut encoding = self.encoding(recorder, first);
        draw::encode(&mut encoding, group.filter_map(|index| self.part(index)));
        leader.into_iter().for_each(|index| self.timing.recorded(index, began));
    }

    fn part(&self, index: usize) -> Option<draw::Part<'_>> {
        let pass = &self.plan.passes[index];
        let variant = self.variants[index].get(self.rotation_key(index))?;
        let Variant::Draw(variant) = variant else { return None };
        Some(draw::Part { pass, variant })
    }

    fn encoding<'a, 'b>(&'a self, recorder: &'a mut Recorder<'b>, pair: Option<u32>) -> Encoding<'a, 'b> {
        Encoding {
            recorder,
            plan: &self.plan,
            pool: &self.pool,
            fixed: &self.fixed,
            rotation: &self.rotation,
            timing: &self.timing,
            pair,
        }
    }

    fn record(&self, recorder: &mut Recorder<'_>, index: usize, key: usize, pair: Option<u32>) {
        let Some(variant) = self.variants[index].get(key) else { return };
        let pipeline = self.pipelines[index].as_deref();
        self.encoding(recorder, pair).pass(&self.plan.passes[index], pipeline, variant);
    }

    /// Which passes the device refuses, found by encoding each on its own.
    pub(in crate::engine) fn blame(&mut self, gpu: &Gpu) -> Option<Diagnostics> {
        let mut found = Diagnostics::new();
        if self.begin_parts(gpu, true).is_err() {
            return None;
        }
        for index in 0..self.plan.passes.len() {
            // Nothing is handed over: only memory changes.
            if self.cut(gpu, &mut Recorder::new(gpu), index).is_err() {
                return None;
            }
            let refused = match self.ensure_variant(gpu, index) {
                Err(diagnostic) => Some(diagnostic),
                Ok(key) => {
                    let mut recorder = Recorder::new(gpu);
                    let pass = &self.plan.passes[index];
                    let encoded = errors::scoped(gpu, || {
                        self.record(&mut recorder, index, key, None);
                        recorder.finish()
                    });
                    encoded.err().map(|e| errors::refused("the commands of", &pass.path, pass.span, &e))
                }
            };
            found.0.extend(refused);
        }
        Some(found).filter(|f| !f.is_empty())
    }
}
