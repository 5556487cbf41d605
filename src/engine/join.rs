//! Which draws can share a render pass with the ones before them (rule 27): those with equal
//! targets that load them and touch nothing that the others write.

use super::pool::{Handle, Pool, candidates};
use crate::plan::model::{Bound, ColorTarget, DepthTarget, Draw, ObjectRef, Pass, PassKind, Plan};

/// For each pass the first one of its render pass: itself, if it joins none.
pub(super) fn leaders(plan: &Plan, pool: &Pool) -> Vec<usize> {
    let mut leaders: Vec<usize> = Vec::with_capacity(plan.passes.len());
    let mut group: Option<Group<'_>> = None;
    for (index, pass) in plan.passes.iter().enumerate() {
        let joined = group.as_mut().is_some_and(|g| g.join(plan, pool, pass));
        if !joined {
            group = Group::new(plan, pool, index, pass);
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
    read: Vec<Handle>,
    written: Vec<Handle>,
}

impl<'a> Group<'a> {
    fn new(plan: &Plan, pool: &Pool, leader: usize, pass: &'a Pass) -> Option<Self> {
        let PassKind::Draw(draw) = &pass.kind else { return None };
        let touches = touches(plan, pool, draw);
        Some(Self { leader, last: draw, steps: pass.steps, writes_depth: writes_depth(draw), touches })
    }

    fn join(&mut self, plan: &Plan, pool: &Pool, pass: &'a Pass) -> bool {
        let PassKind::Draw(draw) = &pass.kind else { return false };
        let touches = touches(plan, pool, draw);
        let writes_depth = self.writes_depth || writes_depth(draw);
        let samples_depth = draw.depth.as_ref().is_some_and(|d| {
            let depth = handles(plan, pool, d.view.object);
            meet(&depth, &touches.read) || meet(&depth, &self.touches.read)
        });
        let conflicts = (writes_depth && samples_depth)
            || meet(&self.touches.written, &touches.read)
            || meet(&self.touches.written, &touches.written)
            || meet(&self.touches.read, &touches.written)
            // What is resolved is there only after the render pass.
            || meet(&resolved(plan, pool, self.last), &touches.read)
            || meet(&resolved(plan, pool, draw), &self.touches.read);
        let fits = self.steps == pass.steps && same_targets(self.last, draw) && !conflicts;
        if fits {
            self.last = draw;
            self.writes_depth = writes_depth;
            self.touches.read.extend(touches.read);
            self.touches.written.extend(touches.written);
        }
        fits
    }
}

fn meet(a: &[Handle], b: &[Handle]) -> bool {
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

fn resolved(plan: &Plan, pool: &Pool, draw: &Draw) -> Vec<Handle> {
    let resolves = draw.color.iter().filter_map(|t| t.resolve.as_ref());
    resolves.flat_map(|view| handles(plan, pool, view.object)).collect()
}

fn handles(plan: &Plan, pool: &Pool, object: ObjectRef) -> Vec<Handle> {
    candidates(plan, object).into_iter().map(|id| pool.handle(id)).collect()
}

fn touches(plan: &Plan, pool: &Pool, draw: &Draw) -> Touches {
    let mut touches = Touches::default();
    for binding in &draw.shader.bindings {
        match &binding.bound {
            Bound::Storage { buffer, writable: true } => touches.written.extend(handles(plan, pool, *buffer)),
            Bound::StorageTexture { view, write: true, .. } => {
                touches.written.extend(handles(plan, pool, view.object));
            }
            Bound::Storage { buffer, .. } | Bound::UniformBuffer { buffer } => {
                touches.read.extend(handles(plan, pool, *buffer));
            }
            Bound::Texture { view, .. } | Bound::StorageTexture { view, .. } => {
                touches.read.extend(handles(plan, pool, view.object));
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
