//! What memory a plan's objects have, and what is asked of it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use super::ObjectId;

/// Which objects share memory, see rule 38 of the language.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Policy {
    /// What skipping needs is kept.
    #[default]
    Keep,
    /// Every unit runs in each frame in which any does; lifetimes alone decide.
    Smallest,
}

impl Policy {
    pub fn name(self) -> &'static str {
        match self {
            Policy::Keep => "keep",
            Policy::Smallest => "smallest",
        }
    }
}

/// What somebody asks of a plan's memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MemoryRequest {
    /// Absent: by what changes from frame to frame, and by the budget.
    pub policy: Option<Policy>,
    /// Bytes of textures and buffers that may be held.
    pub budget: Option<u64>,
    /// Of the budget what others take: the presenting graph, the textures of materials.
    pub elsewhere: u64,
    /// Inputs that have another content in each frame: a sequence of files that plays, what an embedder makes
    /// anew. Time then runs too.
    pub moving: BTreeSet<String>,
}

/// Which objects share memory, under both policies of rule 38, and which policy holds.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Memory {
    pub policy: Policy,
    pub why: Why,
    /// Groups of objects that share one piece of memory while everything that skipping needs is
    /// kept.
    pub keep: Vec<Slot>,
    /// The same when every unit runs each frame.
    pub smallest: Vec<Slot>,
    /// Objects that share with nobody while things are kept.
    pub apart: BTreeMap<ObjectId, Apart>,
    /// Bytes of all objects of the frame, each on its own.
    pub unshared: u64,
    /// Bytes of the largest set that is live at once: no plan can hold less.
    pub lower_bound: u64,
    /// The first pass at which that set is live.
    pub largest_at: usize,
    /// Bytes of the largest sets of objects that could lie in one piece of memory, summed: textures
    /// of one description, and buffers. wgpu lets nobody hold less.
    pub alike_bound: u64,
    /// Bytes of inputs and state, which share nothing.
    pub outside: u64,
    pub budget: Option<u64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    pub objects: Vec<ObjectId>,
    pub bytes: u64,
}

/// Why an object of the frame shares with nobody while things are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Apart {
    /// It is an output, or somebody asked for it: it is looked at after the frame.
    LookedAt,
    /// Two units touch it that run for different causes.
    Causes { units: [usize; 2] },
    /// Steps touch it, and passes outside of those.
    Steps,
}

/// Why a policy was chosen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Why {
    /// No input changes in each frame.
    #[default]
    Still,
    /// Of the passes outside of steps so many run in each frame anyway, since inputs change in each.
    Moving { passes: usize, of: usize },
    /// Somebody asked for it.
    Asked,
    /// Keeping takes more than the budget, so many bytes.
    Budget { keeping: u64 },
}

impl Memory {
    pub fn slots(&self, policy: Policy) -> &[Slot] {
        match policy {
            Policy::Keep => &self.keep,
            Policy::Smallest => &self.smallest,
        }
    }

    /// Bytes of textures and buffers that are held under a policy, with inputs and state.
    pub fn held(&self, policy: Policy) -> u64 {
        self.outside + self.slots(policy).iter().map(|slot| slot.bytes).sum::<u64>()
    }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Why::Still => write!(f, "no input changes in each frame"),
            Why::Moving { passes, of } => {
                write!(f, "inputs change in each frame, for which {passes} of {of} passes run")
            }
            Why::Asked => write!(f, "it was asked for"),
            Why::Budget { .. } => write!(f, "keeping takes more than the budget"),
        }
    }
}
