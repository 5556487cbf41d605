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
    Share,
    /// The same, and the frame is cut where that helps: memory that is over is given back in between.
    Smallest,
}

impl Policy {
    /// From the one that holds the most on.
    pub const ALL: [Policy; 3] = [Policy::Keep, Policy::Share, Policy::Smallest];

    pub fn name(self) -> &'static str {
        match self {
            Policy::Keep => "keep",
            Policy::Share => "share",
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

/// Which objects share memory, under each policy of rule 38, and which policy holds.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Memory {
    pub policy: Policy,
    pub why: Why,
    /// Groups of objects that share one piece of memory while everything that skipping needs is
    /// kept.
    pub keep: Vec<Slot>,
    /// The same when every unit runs each frame.
    pub share: Vec<Slot>,
    /// The same when the frame may be cut besides.
    pub smallest: Vec<Slot>,
    /// Where the frame is cut under the smallest policy, in order.
    pub cuts: Vec<Cut>,
    /// Bytes of the frame that are held in each of the parts that cuts make of it.
    pub parts: Vec<u64>,
    /// Objects that share with nobody while things are kept.
    pub apart: BTreeMap<ObjectId, Apart>,
    /// Targets whose content nobody needs after the render pass that draws them.
    pub unstored: BTreeSet<ObjectId>,
    /// Bytes of all objects of the frame, each on its own.
    pub unshared: u64,
    /// Bytes of the largest set that is live at once: no plan can hold less.
    pub lower_bound: u64,
    /// The first pass at which that set is live.
    pub largest_at: usize,
    /// Bytes of the largest sets of objects that could lie in one piece of memory, summed: textures
    /// of one description, and buffers. wgpu lets no frame that is not cut hold less.
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

/// A place in the frame at which memory that is over is given back, and other memory made. What no
/// cut makes is there when the frame begins; what no cut gives back is there when it ends. What is
/// made and not looked at is given back then, the rest when the next frame begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Index into [`super::Plan::passes`].
    pub before: usize,
    /// Indices into [`Memory::smallest`], of what is over.
    pub gives: Vec<usize>,
    /// Of what begins between here and the next cut.
    pub makes: Vec<usize>,
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
            Policy::Share => &self.share,
            Policy::Smallest => &self.smallest,
        }
    }

    /// The cuts of the frame under a policy.
    pub fn cuts(&self, policy: Policy) -> &[Cut] {
        if policy == Policy::Smallest { &self.cuts } else { &[] }
    }

    /// Bytes of the frame's textures and buffers that are held at once under a policy, at the most.
    pub fn of_frame(&self, policy: Policy) -> u64 {
        let all = || self.slots(policy).iter().map(|slot| slot.bytes).sum();
        let most = self.parts.iter().copied().max().filter(|_| !self.cuts(policy).is_empty());
        most.unwrap_or_else(all)
    }

    /// The same with inputs and state.
    pub fn held(&self, policy: Policy) -> u64 {
        self.outside + self.of_frame(policy)
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
