//! The parts of a frame: at each cut of the plan what was recorded is handed over, memory that is
//! over is let go, and once the device is done with it, what comes next is made.
//!
//! Between frames what the first part has and what is looked at is held. Into an embedder's
//! commands nothing can be cut: there all of it is made first, and given back after the frame that
//! follows in commands of our own.

use std::collections::BTreeSet;

use super::bind::references;
use super::encode::Recorder;
use super::gpu::Gpu;
use super::pool::{Handle, Pool, candidates};
use super::prepare::Runner;
use crate::diagnostic::Diagnostic;
use crate::plan::model::{Apart, Plan, Slot};

/// The cuts of a plan, on the memory of its pool.
#[derive(Clone, Debug, Default)]
pub(super) struct Cuts {
    /// What is there when a frame begins.
    first: Vec<Handle>,
    /// What is not, and must not be.
    late: Part,
    /// What of it nobody looks at after the frame.
    unseen: Part,
    cuts: Vec<Cut>,
    /// Bytes of the frame in the part that holds the most.
    most: u64,
}

#[derive(Clone, Debug)]
struct Cut {
    before: usize,
    gives: Part,
    makes: Vec<Handle>,
}

/// Memory, and the passes that bind it.
#[derive(Clone, Debug, Default)]
struct Part {
    handles: Vec<Handle>,
    passes: Vec<usize>,
}

impl Cuts {
    pub fn new(plan: &Plan, pool: &Pool) -> Self {
        let cuts = plan.memory.cuts(plan.memory.policy);
        if cuts.is_empty() {
            return Self::default();
        }
        let of = |slots: &[usize]| handles(slots.iter().filter_map(|slot| plan.memory.smallest.get(*slot)), pool);
        let is_seen = |slot: &&usize| {
            let objects = plan.memory.smallest.get(**slot).map_or(&[][..], |slot| &slot.objects);
            objects.iter().any(|id| plan.memory.apart.get(id) == Some(&Apart::LookedAt))
        };
        let late: Vec<usize> = cuts.iter().flat_map(|cut| cut.makes.iter().copied()).collect();
        let unseen: Vec<usize> = late.iter().filter(|slot| !is_seen(slot)).copied().collect();
        let (late, unseen) = (of(&late), of(&unseen));
        let mut first = handles(plan.memory.smallest.iter(), pool);
        first.retain(|handle| !late.contains(handle));
        let cut = |cut: &crate::plan::model::Cut| Cut {
            before: cut.before,
            gives: Part::new(plan, pool, of(&cut.gives)),
            makes: of(&cut.makes),
        };
        let cuts: Vec<Cut> = cuts.iter().map(cut).collect();
        let mut held: BTreeSet<Handle> = first.iter().copied().collect();
        let bytes = |held: &BTreeSet<Handle>| held.iter().map(|handle| pool.bytes_of(*handle)).sum::<u64>();
        let mut most = bytes(&held);
        for cut in &cuts {
            cut.gives.handles.iter().for_each(|handle| _ = held.remove(handle));
            held.extend(&cut.makes);
            most = most.max(bytes(&held));
        }
        let [late, unseen] = [late, unseen].map(|handles| Part::new(plan, pool, handles));
        Self { first, late, unseen, cuts, most }
    }

    pub fn is_empty(&self) -> bool {
        self.cuts.is_empty()
    }

    /// What a preparation leaves for the frame to make.
    pub fn is_late(&self, handle: Handle) -> bool {
        self.late.handles.contains(&handle)
    }

    /// The first cut behind a pass.
    pub fn next(&self, pass: usize) -> Option<usize> {
        self.cuts.iter().map(|cut| cut.before).find(|before| *before > pass)
    }

    /// Bytes of the frame in the part that holds the most, and of what is there when it begins.
    fn bytes(&self, pool: &Pool) -> [u64; 2] {
        [self.most, self.first.iter().map(|handle| pool.bytes_of(*handle)).sum()]
    }
}

fn handles<'s>(slots: impl Iterator<Item = &'s Slot>, pool: &Pool) -> Vec<Handle> {
    let mut handles: Vec<Handle> = slots.flat_map(|slot| slot.objects.iter().map(|id| pool.handle(*id))).collect();
    handles.sort_unstable();
    handles.dedup();
    handles
}

impl Part {
    fn new(plan: &Plan, pool: &Pool, handles: Vec<Handle>) -> Self {
        let binds = |pass: &usize| {
            let objects = references(&plan.passes[*pass]).into_iter().flat_map(|object| candidates(plan, object));
            objects.into_iter().any(|id| handles.contains(&pool.handle(id)))
        };
        let passes = (0..plan.passes.len()).filter(binds).collect();
        Self { handles, passes }
    }
}

impl Runner {
    /// Makes what the frame's first part has; all of it if the frame cannot be cut.
    pub(super) fn begin_parts(&mut self, gpu: &Gpu, is_cut: bool) -> Result<(), Diagnostic> {
        if self.cuts.is_empty() {
            return Ok(());
        }
        let cuts = std::mem::take(&mut self.cuts);
        let made = (|| {
            if is_cut {
                self.give_back(&cuts.late);
                // What the frame before has not done with is still held.
                if cuts.first.iter().any(|handle| !self.pool.is_there(*handle)) {
                    gpu.drain()?;
                }
            } else {
                self.make(gpu, &cuts.late.handles)?;
            }
            self.make(gpu, &cuts.first)
        })();
        self.cuts = cuts;
        self.peak = self.pool.bytes();
        made
    }

    /// Cuts the frame before a pass, if the plan does.
    pub(super) fn cut(&mut self, gpu: &Gpu, recorder: &mut Recorder<'_>, pass: usize) -> Result<(), Diagnostic> {
        let is_it = |cut: &Cut| cut.before == pass;
        if !recorder.is_own() || !self.cuts.cuts.iter().any(is_it) {
            return Ok(());
        }
        let cuts = std::mem::take(&mut self.cuts);
        recorder.submit(gpu);
        let made = cuts.cuts.iter().filter(|cut| is_it(cut)).try_for_each(|cut| {
            self.give_back(&cut.gives);
            recorder.wait(gpu)?;
            self.make(gpu, &cut.makes)
        });
        self.cuts = cuts;
        self.peak = self.peak.max(self.pool.bytes());
        made
    }

    /// Lets go of what was made behind a cut and nobody looks at.
    pub(super) fn end_parts(&mut self, is_cut: bool) {
        if is_cut && !self.cuts.is_empty() {
            let cuts = std::mem::take(&mut self.cuts);
            self.give_back(&cuts.unseen);
            self.cuts = cuts;
        }
    }

    fn give_back(&mut self, part: &Part) {
        part.handles.iter().for_each(|handle| self.pool.let_go(*handle));
        part.passes.iter().for_each(|pass| self.variants[*pass].clear());
    }

    fn make(&mut self, gpu: &Gpu, handles: &[Handle]) -> Result<(), Diagnostic> {
        handles.iter().try_for_each(|handle| self.pool.make(gpu, &self.plan, *handle))
    }

    /// Bytes of textures and buffers that were held at once in the frame that was recorded last, at
    /// the most, without what others share with it.
    pub fn peak_bytes(&self) -> u64 {
        self.peak.max(self.pool.bytes()) + self.materials.bytes()
    }

    /// Bytes that the frame's parts need besides what is held when it begins.
    pub(super) fn later_bytes(&self) -> u64 {
        let [most, first] = self.cuts.bytes(&self.pool);
        most.saturating_sub(first)
    }
}
