//! Uniform blocks in one buffer: what is known is packed once, what is live is packed for each
//! frame or step and uploaded only if it changed.
//!
//! A block that passes of `Steps` use has a place of its own for them, since time and
//! everything with time in it is there that of the step. Values of several steps in one frame
//! wait in a staging buffer, from where the frame copies them before each step.

use std::borrow::Cow;
use std::ops::Range;

use super::gpu::Gpu;
use super::run::StepInfo;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::graph::eval::eval_live;
use crate::graph::expr::ExprKind;
use crate::graph::value::Value;
use crate::plan::changes::Changes;
use crate::plan::model::{Bound, Pass, PassKind, Plan, ShaderUse, UniformMember, UniformValue};
use crate::plan::packing;
use crate::shader::reflect::Type;

/// What gives live names (`time`, `camera.position`) their values.
pub(super) type Live<'a> = &'a dyn Fn(&str, Option<&StepInfo>) -> Option<Value>;

#[derive(Debug)]
struct Place {
    block: usize,
    /// The `Steps` whose passes use it; absent outside any.
    steps: Option<usize>,
    offset: u64,
    live: bool,
    /// A pass that uses it, for messages.
    pass: usize,
}

/// A member whose value frames give: all that it takes to pack it lies here, for there are many.
#[derive(Debug)]
struct Member {
    /// Which of the values that were told; absent where it is put together from several.
    told: Option<usize>,
    ty: Type,
    bytes: Range<usize>,
    /// Of `places`, and of the members of its block.
    place: usize,
    member: usize,
}

#[derive(Debug)]
pub(super) struct Uniforms {
    places: Vec<Place>,
    /// Members of the live places outside of `Steps`, in the order of their bytes.
    members: Vec<Member>,
    /// Where the live places of outside and of each `Steps` lie: contiguous.
    outside: Range<u64>,
    regions: Vec<Range<u64>>,
    bytes: Vec<u8>,
    /// What the device has of `bytes`.
    sent: Vec<u8>,
    /// Whether a live value outside of steps is another than the one that was packed.
    is_stale: bool,
    buffer: Option<wgpu::Buffer>,
    staging: Option<wgpu::Buffer>,
    staged: Vec<u8>,
}

impl Uniforms {
    /// # Errors
    /// For each known value that does not fit its member.
    pub fn new(gpu: &Gpu, plan: &Plan, known: &Changes) -> Result<Self, Diagnostics> {
        let alignment = u64::from(gpu.limits().min_uniform_buffer_offset_alignment);
        let mut places = wanted(plan);
        // Live ones of one context lie together; those that never change come first.
        places.sort_by_key(|p| (p.live, p.steps, p.block));
        let mut offset = 0;
        for place in &mut places {
            place.offset = offset;
            offset = (offset + u64::from(plan.uniforms[place.block].size.max(16))).next_multiple_of(alignment);
        }
        let region = |steps: Option<usize>| {
            let mut ends = places
                .iter()
                .filter(|p| p.live && p.steps == steps)
                .map(|p| p.offset..(p.offset + u64::from(plan.uniforms[p.block].size.max(16))).next_multiple_of(4));
            let first = ends.next().unwrap_or(0..0);
            first.start..ends.next_back().map_or(first.end, |last| last.end)
        };
        let (outside, regions) = (region(None), (0..plan.steps.len()).map(|s| region(Some(s))).collect());
        let buffer = (offset > 0).then(|| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("uniforms"),
                size: offset,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        });
        let bytes = vec![0; offset as usize];
        let (sent, staged) = (Vec::new(), Vec::new());
        let mut uniforms = Self {
            places,
            members: Vec::new(),
            outside,
            regions,
            bytes,
            sent,
            is_stale: true,
            buffer,
            staging: None,
            staged,
        };
        uniforms.members = uniforms.live_members(plan, known);
        uniforms.pack_known(plan)?;
        uniforms.sent.clone_from(&uniforms.bytes);
        if let Some(buffer) = &uniforms.buffer {
            gpu.write_buffer(buffer, 0, &uniforms.bytes);
        }
        Ok(uniforms)
    }

    /// The buffer and the range of a block as a pass sees it.
    pub fn binding(&self, plan: &Plan, pass: &Pass, block: usize) -> Option<wgpu::BufferBinding<'_>> {
        let place = self.places.iter().find(|p| p.block == block && (!p.live || p.steps == pass.steps))?;
        Some(wgpu::BufferBinding {
            buffer: self.buffer.as_ref()?,
            offset: place.offset,
            size: wgpu::BufferSize::new(u64::from(plan.uniforms[block].size.max(16))),
        })
    }

    fn pack_known(&mut self, plan: &Plan) -> Result<(), Diagnostics> {
        let mut found = Diagnostics::new();
        for place in &self.places {
            for member in &plan.uniforms[place.block].members {
                if let UniformValue::Known(value) = &member.value
                    && let Err(diagnostic) = pack(&mut self.bytes, place, plan, member, value)
                {
                    found.push(diagnostic);
                }
            }
        }
        if found.is_empty() { Ok(()) } else { Err(found) }
    }

    /// Tells that a live value outside of steps is another.
    pub fn note_change(&mut self) {
        self.is_stale = true;
    }

    /// Packs the live places outside `Steps`, if a value is another, and uploads them if that shows.
    /// `known` has the values that were told of names, `live` those that nobody told of.
    ///
    /// # Errors
    /// If a live name has no value or one that does not fit.
    pub fn write_frame(&mut self, gpu: &Gpu, plan: &Plan, known: &Changes, live: Live<'_>) -> Result<(), Diagnostics> {
        if !self.is_stale && !known.is_blind() {
            return Ok(());
        }
        self.pack_outside(plan, known, live)?;
        self.is_stale = false;
        let region = span(&self.outside);
        if let Some(buffer) = &self.buffer
            && self.sent[region.clone()] != self.bytes[region.clone()]
        {
            gpu.write_buffer(buffer, self.outside.start, &self.bytes[region.clone()]);
            self.sent[region.clone()].copy_from_slice(&self.bytes[region]);
        }
        Ok(())
    }

    /// Packs the values of all steps that a frame runs, in their order, and hands them to the
    /// staging buffer. [`Uniforms::begin_step`] takes them from there one by one.
    ///
    /// # Errors
    /// As [`Uniforms::write_frame`].
    pub fn stage_steps(
        &mut self,
        gpu: &Gpu,
        plan: &Plan,
        steps: &[StepInfo],
        live: Live<'_>,
    ) -> Result<(), Diagnostics> {
        self.staged.clear();
        for info in steps {
            self.pack_step(plan, info.steps, &|name| live(name, Some(info)))?;
            self.staged.extend_from_slice(&self.bytes[span(&self.regions[info.steps])]);
        }
        if self.staged.is_empty() {
            return Ok(());
        }
        let needed = self.staged.len() as u64;
        if self.staging.as_ref().is_none_or(|s| s.size() < needed) {
            self.staging = Some(gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("uniforms of steps"),
                size: needed.next_power_of_two(),
                usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        if let Some(staging) = &self.staging {
            gpu.write_buffer(staging, 0, &self.staged);
        }
        Ok(())
    }

    /// Puts the next step's values in place. `at` counts bytes of the staging buffer.
    pub fn begin_step(&self, encoder: &mut wgpu::CommandEncoder, steps: usize, at: &mut u64) {
        let region = &self.regions[steps];
        let length = region.end - region.start;
        if let (Some(staging), Some(buffer)) = (&self.staging, &self.buffer)
            && length > 0
        {
            encoder.copy_buffer_to_buffer(staging, *at, buffer, region.start, length);
            *at += length;
        }
    }

    fn live_members(&self, plan: &Plan, known: &Changes) -> Vec<Member> {
        let live = self.places.iter().enumerate().filter(|(_, p)| p.live && p.steps.is_none());
        let members = live.flat_map(|(place, p)| {
            let block = &plan.uniforms[p.block];
            let member = move |(member, about): (usize, &UniformMember)| {
                let UniformValue::Live(expr) = &about.value else { return None };
                let told = match &expr.kind {
                    ExprKind::Name(name) => known.live_place(name),
                    _ => None,
                };
                let start = p.offset as usize + about.offset as usize;
                let bytes = start..p.offset as usize + block.size.max(16) as usize;
                Some(Member { told, ty: about.ty.clone(), bytes, place, member })
            };
            block.members.iter().enumerate().filter_map(member)
        });
        members.collect()
    }

    /// Packs the live places outside of steps.
    fn pack_outside(&mut self, plan: &Plan, known: &Changes, live: Live<'_>) -> Result<(), Diagnostics> {
        let either = |name: &str| known.live_value(name).cloned().or_else(|| live(name, None));
        let mut found = Diagnostics::new();
        for member in &self.members {
            let place = &self.places[member.place];
            let about = || &plan.uniforms[place.block].members[member.member];
            let value = match member.told.and_then(|told| known.live_value_at(told)) {
                Some(value) => Some(Cow::Borrowed(value)),
                None => live_value(about(), &either).map(Cow::Owned),
            };
            let out = self.bytes.get_mut(member.bytes.clone()).unwrap_or_default();
            let packed = match value {
                Some(value) => packing::encode(&value, &member.ty, out).map_err(|e| misfit(plan, place, about(), &e)),
                None => Err(nothing_gives(plan, place, about())),
            };
            found.0.extend(packed.err());
        }
        if found.is_empty() { Ok(()) } else { Err(found) }
    }

    /// Packs the places of a `Steps` for one of its steps.
    fn pack_step(
        &mut self,
        plan: &Plan,
        steps: usize,
        live: &dyn Fn(&str) -> Option<Value>,
    ) -> Result<(), Diagnostics> {
        let mut found = Diagnostics::new();
        for place in self.places.iter().filter(|p| p.live && p.steps == Some(steps)) {
            for member in &plan.uniforms[place.block].members {
                if !matches!(member.value, UniformValue::Live(_)) {
                    continue;
                }
                let packed = match live_value(member, live) {
                    Some(value) => pack(&mut self.bytes, place, plan, member, &value),
                    None => Err(nothing_gives(plan, place, member)),
                };
                found.0.extend(packed.err());
            }
        }
        if found.is_empty() { Ok(()) } else { Err(found) }
    }
}

fn live_value(member: &UniformMember, live: &dyn Fn(&str) -> Option<Value>) -> Option<Value> {
    match &member.value {
        UniformValue::Live(expr) => eval_live(expr, live),
        UniformValue::Known(value) => Some(value.clone()),
    }
}

fn nothing_gives(plan: &Plan, place: &Place, member: &UniformMember) -> Diagnostic {
    let message = format!("nothing gives `{}` of `{}` a value", member.name, plan.passes[place.pass].path);
    let error = Diagnostic::error(Code::MISSING_INPUT, message);
    match &member.value {
        UniformValue::Live(expr) => error.at(expr.span, "asked for here"),
        UniformValue::Known(_) => error,
    }
}

fn misfit(plan: &Plan, place: &Place, member: &UniformMember, message: &str) -> Diagnostic {
    let pass = &plan.passes[place.pass];
    Diagnostic::error(Code::UNIFORM_MISMATCH, format!("`{}` of `{}`: {message}", member.name, pass.path))
        .at(pass.span, "packed for this pass")
}

fn span(region: &Range<u64>) -> Range<usize> {
    region.start as usize..region.end as usize
}

fn pack(bytes: &mut [u8], place: &Place, plan: &Plan, member: &UniformMember, value: &Value) -> Result<(), Diagnostic> {
    let block = &plan.uniforms[place.block];
    let (start, end) = (place.offset as usize, place.offset as usize + block.size.max(16) as usize);
    let out = bytes.get_mut(start + member.offset as usize..end).unwrap_or_default();
    packing::encode(value, &member.ty, out).map_err(|message| misfit(plan, place, member, &message))
}

/// Each block with each context that uses it; blocks without live members once.
fn wanted(plan: &Plan) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for (index, pass) in plan.passes.iter().enumerate() {
        for block in shader(&pass.kind).into_iter().flat_map(blocks) {
            let live = plan.uniforms[block].members.iter().any(|m| matches!(m.value, UniformValue::Live(_)));
            let steps = pass.steps.filter(|_| live);
            if !places.iter().any(|p| p.block == block && p.steps == steps) {
                places.push(Place { block, steps, offset: 0, live, pass: index });
            }
        }
    }
    places
}

fn shader(kind: &PassKind) -> Option<&ShaderUse> {
    match kind {
        PassKind::Compute { shader, .. } => Some(shader),
        PassKind::Draw(draw) => Some(&draw.shader),
        _ => None,
    }
}

fn blocks(shader: &ShaderUse) -> impl Iterator<Item = usize> {
    shader.bindings.iter().filter_map(|b| match b.bound {
        Bound::Uniform { block } => Some(block),
        _ => None,
    })
}
