//! Textures and buffers by description. Objects keep their handle; what stands behind it may be
//! swapped (shared from another graph, made anew at a reset, taken over at a reload).

use std::collections::BTreeSet;

use wgpu_types::{BufferUsages, TextureUsages};

use super::bind::references;
use super::cuts::Cuts;
use super::errors;
use super::gpu::Gpu;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::format;
use crate::plan::merge;
use crate::plan::model::{ObjectId, ObjectKind, ObjectRef, Origin, PassKind, Plan, Texture};
use crate::plan::unstored;

/// A piece of memory.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Memory {
    Texture(wgpu::Texture),
    Buffer(wgpu::Buffer),
}

/// What a piece of memory is, with all usages.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Description {
    Texture(Texture),
    Buffer { bytes: u64, usages: BufferUsages },
}

/// Stands for the memory of one or more objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Handle(usize);

impl Handle {
    /// The same for objects that share memory.
    pub fn number(self) -> usize {
        self.0
    }
}

#[derive(Clone, Debug)]
struct Slot {
    description: Description,
    /// The path and origin of its first object.
    label: String,
    origin: Origin,
    first: ObjectId,
    /// How many objects it stands for.
    members: usize,
    memory: Option<Memory>,
    /// It belongs to somebody else.
    foreign: bool,
}

#[derive(Debug)]
pub(super) struct Pool {
    slots: Vec<Slot>,
    of: Vec<Handle>,
    /// Of each object, whether its content is needed by nobody after the render pass that draws it.
    unstored: Vec<bool>,
    /// Whether the device has no memory for what is transient.
    saves_transient: bool,
}

impl Pool {
    /// Lays out the objects of a plan, takes over what fits of an earlier pool, and makes the
    /// rest, but for inputs, which get memory when somebody fills or shares them, and for what the
    /// frame makes behind a cut.
    ///
    /// `state_kept[steps]` says whether the state of that block goes on.
    ///
    /// # Errors
    /// For each object that the device refuses.
    pub fn new(
        gpu: &Gpu,
        plan: &Plan,
        previous: Option<&Pool>,
        state_kept: &[bool],
    ) -> Result<(Self, Cuts), Diagnostics> {
        let mut pool = Self::lay_out(gpu, plan);
        pool.leave_unstored(gpu, plan);
        let cuts = Cuts::new(plan, &pool);
        if let Some(previous) = previous {
            pool.take_over(previous, state_kept, &cuts);
        }
        let mut found = Diagnostics::new();
        // What passes that were left out would have used has no use, and no memory.
        let used: BTreeSet<Handle> = used(plan).into_iter().map(|id| pool.of[id]).collect();
        for at in 0..pool.slots.len() {
            if !is_input(&pool.slots[at].origin)
                && !cuts.is_late(Handle(at))
                && used.contains(&Handle(at))
                && let Err(diagnostic) = pool.ensure_slot(gpu, plan, at)
            {
                found.push(diagnostic);
            }
        }
        if found.is_empty() { Ok((pool, cuts)) } else { Err(found) }
    }

    fn lay_out(gpu: &Gpu, plan: &Plan) -> Self {
        let mut descriptions: Vec<_> = plan.objects.iter().map(|o| describe(&o.kind)).collect();
        widen(gpu, plan, &mut descriptions);
        let groups = plan.memory.slots(plan.memory.policy);
        let mut of: Vec<Option<Handle>> = vec![None; plan.objects.len()];
        let mut slots: Vec<Slot> = Vec::new();
        let singles = (0..plan.objects.len()).map(|id| vec![id]);
        for group in groups.iter().map(|slot| slot.objects.clone()).chain(singles) {
            // The slot of the group, as long as all fit.
            let mut open: Option<usize> = None;
            for id in group {
                if of.get(id).is_none_or(Option::is_some) {
                    continue;
                }
                let joined = open.map(|at| &mut slots[at]).is_some_and(|slot| {
                    let fits = merge(&mut slot.description, &descriptions[id]);
                    slot.members += usize::from(fits);
                    fits
                });
                if !joined {
                    slots.push(Slot {
                        description: descriptions[id].clone(),
                        label: plan.objects[id].path.clone(),
                        origin: plan.objects[id].origin.clone(),
                        first: id,
                        members: 1,
                        memory: None,
                        foreign: false,
                    });
                    open = Some(slots.len() - 1);
                }
                of[id] = Some(Handle(slots.len() - 1));
            }
        }
        let of: Vec<Handle> = of.into_iter().flatten().collect();
        let saves_transient = gpu.info().transient_saves_memory == Some(true);
        Self { slots, unstored: vec![false; of.len()], of, saves_transient }
    }

    /// Finds what no render pass has to store where draws share those as they do on this memory, and
    /// makes it transient where nothing else lies in its memory.
    fn leave_unstored(&mut self, gpu: &Gpu, plan: &Plan) {
        if plan.memory.unstored.is_empty() {
            return;
        }
        let mut leaders = merge::leaders(plan, &|id| self.of[id].number());
        for cut in plan.memory.cuts(plan.memory.policy) {
            // Its memory is that of another render pass from there on.
            let parted = leaders.iter_mut().skip(cut.before).filter(|leader| **leader < cut.before);
            parted.for_each(|leader| *leader = cut.before);
        }
        for id in unstored::unstored(plan, &leaders).intersection(&plan.memory.unstored) {
            self.unstored[*id] = true;
        }
        // In a browser nobody knows whether it knows of transient textures.
        let is_known = gpu.info().transient_saves_memory.is_some();
        let mut all = vec![is_known; self.slots.len()];
        for (id, handle) in self.of.iter().enumerate() {
            all[handle.0] &= self.unstored[id];
        }
        for (slot, _) in self.slots.iter_mut().zip(all).filter(|(_, all)| *all) {
            if let Description::Texture(t) = &mut slot.description
                && (t.layers, t.mips) == (1, 1)
            {
                t.usages = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TRANSIENT_ATTACHMENT;
            }
        }
    }

    /// Whether nobody needs an object's content after the render pass that draws it.
    pub fn is_unstored(&self, object: ObjectId) -> bool {
        self.unstored.get(object) == Some(&true)
    }

    /// Whether an object's memory can be filled from outside.
    pub fn is_transient(&self, object: ObjectId) -> bool {
        let description = &self.slots[self.of[object].0].description;
        matches!(description, Description::Texture(t) if t.usages.contains(TextureUsages::TRANSIENT_ATTACHMENT))
    }

    /// Memory of the same path and description first, then any of the same description that
    /// nobody else takes. State and inputs only ever go to their own name.
    fn take_over(&mut self, previous: &Pool, state_kept: &[bool], cuts: &Cuts) {
        let mut taken = vec![false; previous.slots.len()];
        let may = |at: usize| !cuts.is_late(Handle(at));
        for (_, slot) in self.slots.iter_mut().enumerate().filter(|(at, _)| may(*at)) {
            if matches!(slot.origin, Origin::State(steps) if state_kept.get(steps) != Some(&true)) {
                continue;
            }
            let same = previous.slots.iter().position(|old| {
                old.label == slot.label
                    && old.description == slot.description
                    && std::mem::discriminant(&old.origin) == std::mem::discriminant(&slot.origin)
            });
            if let Some(at) = same.filter(|at| !taken[*at]) {
                taken[at] = true;
                slot.memory.clone_from(&previous.slots[at].memory);
                slot.foreign = previous.slots[at].foreign;
            }
        }
        let wants = |slot: &Slot| slot.memory.is_none() && slot.origin == Origin::Frame;
        for (_, slot) in self.slots.iter_mut().enumerate().filter(|(at, slot)| may(*at) && wants(slot)) {
            let fits =
                previous.slots.iter().enumerate().position(|(at, old)| {
                    !taken[at] && old.origin == Origin::Frame && old.description == slot.description
                });
            if let Some(at) = fits {
                taken[at] = true;
                slot.memory.clone_from(&previous.slots[at].memory);
            }
        }
    }

    pub fn handle(&self, object: ObjectId) -> Handle {
        self.of[object]
    }

    /// Whether an object's memory is that of other objects too, so that what it holds is there only
    /// while it lives.
    pub fn shares(&self, object: ObjectId) -> bool {
        self.slots[self.of[object].0].members > 1
    }

    pub fn memory(&self, object: ObjectId) -> Option<&Memory> {
        self.slots[self.of[object].0].memory.as_ref()
    }

    pub fn texture(&self, object: ObjectId) -> Option<&wgpu::Texture> {
        match self.memory(object) {
            Some(Memory::Texture(texture)) => Some(texture),
            _ => None,
        }
    }

    pub fn buffer(&self, object: ObjectId) -> Option<&wgpu::Buffer> {
        match self.memory(object) {
            Some(Memory::Buffer(buffer)) => Some(buffer),
            _ => None,
        }
    }

    /// Makes memory for an object if it has none. Tells whether it made any.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn ensure(&mut self, gpu: &Gpu, plan: &Plan, object: ObjectId) -> Result<bool, Diagnostic> {
        self.ensure_slot(gpu, plan, self.of[object].0)
    }

    fn ensure_slot(&mut self, gpu: &Gpu, plan: &Plan, at: usize) -> Result<bool, Diagnostic> {
        let slot = &mut self.slots[at];
        if slot.memory.is_some() {
            return Ok(false);
        }
        let memory = errors::scoped(gpu, || create(gpu, &slot.description, &slot.label))
            .map_err(|e| errors::refused("the resource", &slot.label, plan.objects[slot.first].span, &e))?;
        slot.memory = Some(memory);
        slot.foreign = false;
        Ok(true)
    }

    /// Lets go of an object's memory; [`Pool::ensure`] then makes zeroed memory.
    pub fn forget(&mut self, object: ObjectId) {
        let slot = &mut self.slots[self.of[object].0];
        slot.memory = None;
        slot.foreign = false;
    }

    /// Lets go of the memory that a handle stands for.
    pub fn let_go(&mut self, handle: Handle) {
        self.slots[handle.0].memory = None;
    }

    /// Makes the memory that a handle stands for, if it is not there.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn make(&mut self, gpu: &Gpu, plan: &Plan, handle: Handle) -> Result<(), Diagnostic> {
        self.ensure_slot(gpu, plan, handle.0).map(|_| ())
    }

    pub fn is_there(&self, handle: Handle) -> bool {
        self.slots[handle.0].memory.is_some()
    }

    /// Bytes of what a handle stands for, there or not.
    pub fn bytes_of(&self, handle: Handle) -> u64 {
        self.bytes_in(&self.slots[handle.0].description)
    }

    fn bytes_in(&self, description: &Description) -> u64 {
        match description {
            Description::Texture(t)
                if self.saves_transient && t.usages.contains(TextureUsages::TRANSIENT_ATTACHMENT) =>
            {
                0
            }
            _ => bytes(description),
        }
    }

    /// Puts somebody else's memory behind an object's handle. Tells whether that is news.
    pub fn share(&mut self, object: ObjectId, memory: Memory) -> bool {
        let slot = &mut self.slots[self.of[object].0];
        let news = slot.memory.as_ref() != Some(&memory);
        slot.memory = Some(memory);
        slot.foreign = true;
        news
    }

    /// Somebody else's memory that an object has.
    pub fn foreign(&self, object: ObjectId) -> Option<&Memory> {
        let slot = &self.slots[self.of[object].0];
        slot.memory.as_ref().filter(|_| slot.foreign)
    }

    /// Makes sure that an object's memory is not somebody else's before it is written.
    pub fn own(&mut self, object: ObjectId) {
        if self.slots[self.of[object].0].foreign {
            self.forget(object);
        }
    }

    /// Bytes that are held, without what belongs to others.
    pub fn bytes(&self) -> u64 {
        let held = self.slots.iter().filter(|s| s.memory.is_some() && !s.foreign);
        held.map(|s| self.bytes_in(&s.description)).sum()
    }
}

fn is_input(origin: &Origin) -> bool {
    origin.input().is_some()
}

fn describe(kind: &ObjectKind) -> Description {
    match kind {
        ObjectKind::Texture(texture) => Description::Texture(texture.clone()),
        ObjectKind::Buffer(buffer) => Description::Buffer { bytes: buffer.bytes(), usages: buffer.usages },
    }
}

/// Joins two descriptions if one piece of memory can serve both.
fn merge(into: &mut Description, other: &Description) -> bool {
    match (into, other) {
        (Description::Texture(a), Description::Texture(b)) => {
            let usages = a.usages | b.usages;
            let alike = Texture { usages, ..a.clone() } == Texture { usages, ..b.clone() };
            if alike {
                a.usages = usages;
            }
            alike
        }
        (Description::Buffer { bytes, usages }, Description::Buffer { bytes: more, usages: others }) => {
            *bytes = (*bytes).max(*more);
            *usages |= *others;
            true
        }
        _ => false,
    }
}

/// Adds what the engine itself does with memory: reading back, uploading, clearing, mips.
fn widen(gpu: &Gpu, plan: &Plan, descriptions: &mut [Description]) {
    for description in &mut *descriptions {
        match description {
            Description::Texture(t) if t.samples == 1 => {
                t.usages |= TextureUsages::COPY_SRC | TextureUsages::COPY_DST;
                if t.format.is_depth_stencil_format() {
                    t.usages |= TextureUsages::TEXTURE_BINDING;
                }
            }
            // What has samples must be a target; it is copied only where a pass says so.
            Description::Texture(t) => t.usages |= TextureUsages::RENDER_ATTACHMENT,
            Description::Buffer { usages, .. } => *usages |= BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        }
    }
    for pass in &plan.passes {
        if let PassKind::Copy { from, to } = &pass.kind {
            for (object, usage) in [(from.object, TextureUsages::COPY_SRC), (to.object, TextureUsages::COPY_DST)] {
                for id in candidates(plan, object) {
                    if let Description::Texture(t) = &mut descriptions[id] {
                        t.usages |= usage;
                    }
                }
            }
        }
        let (object, mips) = match &pass.kind {
            PassKind::Clear { view, .. } => (view.object, false),
            PassKind::Mips { texture } => (*texture, true),
            PassKind::Settle { counted, .. } => (*counted, false),
            _ => continue,
        };
        for id in candidates(plan, object) {
            match &mut descriptions[id] {
                Description::Texture(t) => widen_texture(gpu, t, mips),
                Description::Buffer { usages, .. } => *usages |= BufferUsages::STORAGE,
            }
        }
    }
}

fn widen_texture(gpu: &Gpu, texture: &mut Texture, mips: bool) {
    let renderable = !texture.is_3d && format::is_renderable(texture.format, gpu.features());
    if renderable {
        texture.usages |= TextureUsages::RENDER_ATTACHMENT;
    }
    if mips {
        texture.usages |= TextureUsages::TEXTURE_BINDING;
        if !renderable {
            texture.usages |= TextureUsages::STORAGE_BINDING;
        }
    }
}

/// Objects that passes use, and outputs.
fn used(plan: &Plan) -> BTreeSet<ObjectId> {
    let of_passes = plan.passes.iter().flat_map(references);
    of_passes.chain(plan.outputs.iter().map(|o| o.object)).flat_map(|object| candidates(plan, object)).collect()
}

/// Every object that a reference can stand for.
pub(super) fn candidates(plan: &Plan, object: ObjectRef) -> Vec<ObjectId> {
    match object {
        ObjectRef::Fixed(id) => vec![id],
        ObjectRef::Ring { ring, .. } => plan.rings[ring].objects.clone(),
    }
}

fn create(gpu: &Gpu, description: &Description, label: &str) -> Memory {
    match description {
        Description::Texture(t) => Memory::Texture(gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: t.width, height: t.height, depth_or_array_layers: t.layers },
            mip_level_count: t.mips,
            sample_count: t.samples,
            dimension: if t.is_3d { wgpu::TextureDimension::D3 } else { wgpu::TextureDimension::D2 },
            format: t.format,
            usage: t.usages,
            view_formats: &[],
        })),
        Description::Buffer { bytes, usages } => Memory::Buffer(gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: *bytes,
            usage: *usages,
            mapped_at_creation: false,
        })),
    }
}

fn bytes(description: &Description) -> u64 {
    match description {
        Description::Buffer { bytes, .. } => *bytes,
        Description::Texture(t) => {
            let texel = t.format.block_copy_size(None).or_else(|| t.format.target_pixel_byte_cost()).unwrap_or(4);
            let mips = (0..t.mips).map(|m| {
                let depth = if t.is_3d { (t.layers >> m).max(1) } else { t.layers };
                u64::from((t.width >> m).max(1)) * u64::from((t.height >> m).max(1)) * u64::from(depth)
            });
            mips.sum::<u64>() * u64::from(texel) * u64::from(t.samples)
        }
    }
}
