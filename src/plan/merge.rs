//! Which passes share a pass of the device: dispatches that follow each other, and draws into
//! equal targets that load them and touch nothing that the others write (rule 27).
//!
//! The engine joins dispatches as they come, also where passes between them are skipped; draws
//! it joins as is said here.

use std::ops::Range;

use super::model::{Bound, ColorTarget, DepthTarget, Draw, ObjectId, ObjectKind, ObjectRef, Pass, PassKind, Plan};

/// Passes that share one of the device's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shared {
    pub passes: Range<usize>,
    pub kind: SharedKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SharedKind {
    /// Dispatches in one compute pass.
    Compute,
    /// Draws in one render pass.
    Render,
    /// One that is no pass of the device's, or several.
    Alone,
}

/// All passes of a plan, put together as the device sees them if all of them run. `memory` gives
/// objects that share memory the same number.
pub fn shared(plan: &Plan, memory: &dyn Fn(ObjectId) -> usize) -> Vec<Shared> {
    let leaders = leaders(plan, memory);
    let mut all: Vec<Shared> = Vec::new();
    for (at, pass) in plan.passes.iter().enumerate() {
        let kind = kind(plan, &pass.kind);
        let joins = all.last().is_some_and(|last| {
            let first = &plan.passes[last.passes.start];
            match kind {
                SharedKind::Compute => last.kind == kind && first.steps == pass.steps,
                SharedKind::Render => last.kind == kind && leaders[at] == last.passes.start,
                SharedKind::Alone => false,
            }
        });
        match all.last_mut().filter(|_| joins) {
            Some(last) => last.passes.end = at + 1,
            None => all.push(Shared { passes: at..at + 1, kind }),
        }
    }
    all
}

fn kind(plan: &Plan, kind: &PassKind) -> SharedKind {
    match kind {
        PassKind::Compute { .. } | PassKind::Settle { .. } => SharedKind::Compute,
        PassKind::Draw(_) => SharedKind::Render,
        PassKind::Clear { view, value } => {
            let first = candidates(plan, view.object).into_iter().next();
            match first.map(|id| &plan.objects[id].kind) {
                Some(ObjectKind::Buffer(_)) if value[0] != 0.0 => SharedKind::Compute,
                _ => SharedKind::Alone,
            }
        }
        PassKind::Copy { .. } | PassKind::Mips { .. } | PassKind::Arguments { .. } => SharedKind::Alone,
    }
}

/// Every object that a reference can stand for.
pub(super) fn candidates(plan: &Plan, object: ObjectRef) -> Vec<ObjectId> {
    match object {
        ObjectRef::Fixed(id) => vec![id],
        ObjectRef::Ring { ring, .. } => plan.rings[ring].objects.clone(),
    }
}

/// What gives objects that share memory the same number.
type Memory<'a> = &'a dyn Fn(ObjectId) -> usize;

/// For each pass the first one of its render pass: itself, if it joins none.
pub fn leaders(plan: &Plan, memory: &dyn Fn(ObjectId) -> usize) -> Vec<usize> {
    let mut leaders: Vec<usize> = Vec::with_capacity(plan.passes.len());
    let mut group: Option<Group<'_>> = None;
    for (index, pass) in plan.passes.iter().enumerate() {
        let joined = group.as_mut().is_some_and(|g| g.join(plan, memory, pass));
        if !joined {
            group = Group::new(plan, memory, index, pass);
        }
        leaders.push(group.as_ref().map_or(index, |g| g.leader));
    }
    leaders
}

/// Draws of one render pass so far.
struct Group<'a> {
    leader: usize,
    last: &'a Draw,
    steps: Option<usize>,
    writes_depth: bool,
    touches: Touches,
}

/// What draws touch besides their targets.
#[derive(Default)]
struct Touches {
    read: Vec<usize>,
    written: Vec<usize>,
}

impl<'a> Group<'a> {
    fn new(plan: &Plan, memory: Memory<'_>, leader: usize, pass: &'a Pass) -> Option<Self> {
        let PassKind::Draw(draw) = &pass.kind else { return None };
        let touches = touches(plan, memory, draw);
        Some(Self { leader, last: draw, steps: pass.steps, writes_depth: writes_depth(draw), touches })
    }

    fn join(&mut self, plan: &Plan, memory: Memory<'_>, pass: &'a Pass) -> bool {
        let PassKind::Draw(draw) = &pass.kind else { return false };
        let touches = touches(plan, memory, draw);
        let fits = self.parting(plan, memory, pass, &touches).is_none();
        if fits {
            self.last = draw;
            self.writes_depth |= writes_depth(draw);
            self.touches.read.extend(touches.read);
            self.touches.written.extend(touches.written);
        }
        fits
    }

    /// Why a pass cannot be drawn with these.
    fn parting(&self, plan: &Plan, memory: Memory<'_>, pass: &Pass, touches: &Touches) -> Option<&'static str> {
        let PassKind::Draw(draw) = &pass.kind else { return Some("it is no draw") };
        let samples_depth = || {
            draw.depth.as_ref().is_some_and(|d| {
                let depth = handles(plan, memory, d.view.object);
                meet(&depth, &touches.read) || meet(&depth, &self.touches.read)
            })
        };
        let parted = |is_so: bool, why: &'static str| is_so.then_some(why);
        parted(self.steps != pass.steps, "it is in other steps")
            .or_else(|| parted(!same_targets(self.last, draw), "it has other targets, or does not load them"))
            .or_else(|| {
                let writes_depth = self.writes_depth || writes_depth(draw);
                parted(writes_depth && samples_depth(), "depth is written and sampled")
            })
            .or_else(|| {
                let conflicts = meet(&self.touches.written, &touches.read)
                    || meet(&self.touches.written, &touches.written)
                    || meet(&self.touches.read, &touches.written);
                parted(conflicts, "one of them writes what the other uses")
            })
            .or_else(|| {
                // What is resolved is there only after the render pass.
                let resolves = meet(&resolved(plan, memory, self.last), &touches.read)
                    || meet(&resolved(plan, memory, draw), &self.touches.read);
                parted(resolves, "one of them reads what is resolved after the other")
            })
    }
}

/// Why a pass shares no pass of the device with the one before it; absent if it does, or if it is the first.
pub fn parting(plan: &Plan, memory: &dyn Fn(ObjectId) -> usize, at: usize) -> Option<&'static str> {
    let before = at.checked_sub(1)?;
    let (last, pass) = (&plan.passes[before], &plan.passes[at]);
    let (was, is) = (kind(plan, &last.kind), kind(plan, &pass.kind));
    match (was, is) {
        (SharedKind::Compute, SharedKind::Compute) => (last.steps != pass.steps).then_some("it is in other steps"),
        (SharedKind::Render, SharedKind::Render) => {
            let leader = leaders(plan, memory)[before];
            let mut group = Group::new(plan, memory, leader, &plan.passes[leader])?;
            plan.passes[leader + 1..at].iter().for_each(|pass| _ = group.join(plan, memory, pass));
            let PassKind::Draw(draw) = &pass.kind else { return None };
            group.parting(plan, memory, pass, &touches(plan, memory, draw))
        }
        (_, SharedKind::Alone) | (SharedKind::Alone, _) => Some("copies and clears are no passes of the device"),
        (SharedKind::Compute, SharedKind::Render) | (SharedKind::Render, SharedKind::Compute) => {
            Some("one of them draws, the other dispatches")
        }
    }
}

fn meet(a: &[usize], b: &[usize]) -> bool {
    a.iter().any(|handle| b.contains(handle))
}

fn writes_depth(draw: &Draw) -> bool {
    draw.depth.as_ref().is_some_and(|d| {
        d.write || d.clear.is_some() || d.stencil.as_ref().is_some_and(|s| s.write_mask != 0 || s.clear.is_some())
    })
}

fn same_targets(before: &Draw, draw: &Draw) -> bool {
    let color = |(a, b): (&ColorTarget, &ColorTarget)| {
        let resolve = a.resolve.is_none() || a.resolve == b.resolve;
        a.view == b.view && a.format == b.format && b.clear.is_none() && resolve
    };
    let depth = match (&before.depth, &draw.depth) {
        (None, None) => true,
        (Some(a), Some(b)) => a.view == b.view && a.format == b.format && loads(b),
        _ => false,
    };
    before.samples == draw.samples
        && before.color.len() == draw.color.len()
        && before.color.iter().zip(&draw.color).all(color)
        && depth
}

fn loads(depth: &DepthTarget) -> bool {
    depth.clear.is_none() && depth.stencil.as_ref().is_none_or(|s| s.clear.is_none())
}

fn resolved(plan: &Plan, memory: Memory<'_>, draw: &Draw) -> Vec<usize> {
    let resolves = draw.color.iter().filter_map(|t| t.resolve.as_ref());
    resolves.flat_map(|view| handles(plan, memory, view.object)).collect()
}

fn handles(plan: &Plan, memory: Memory<'_>, object: ObjectRef) -> Vec<usize> {
    candidates(plan, object).into_iter().map(memory).collect()
}

fn touches(plan: &Plan, memory: Memory<'_>, draw: &Draw) -> Touches {
    let mut touches = Touches::default();
    for binding in &draw.shader.bindings {
        match &binding.bound {
            Bound::Storage { buffer, writable: true } => touches.written.extend(handles(plan, memory, *buffer)),
            Bound::StorageTexture { view, write: true, .. } => {
                touches.written.extend(handles(plan, memory, view.object));
            }
            Bound::Storage { buffer, .. } | Bound::UniformBuffer { buffer } => {
                touches.read.extend(handles(plan, memory, *buffer));
            }
            Bound::Texture { view, .. } | Bound::StorageTexture { view, .. } => {
                touches.read.extend(handles(plan, memory, view.object));
            }
            // Materials are inputs, which no pass writes.
            Bound::Uniform { .. }
            | Bound::Sampler { .. }
            | Bound::Material { .. }
            | Bound::MaterialTexture { .. }
            | Bound::MaterialSampler { .. } => {}
        }
    }
    touches
}
