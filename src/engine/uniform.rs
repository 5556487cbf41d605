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

#[derive(Debug)]
pub(super) struct Uniforms {
    places: Vec<Place>,
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
    pub fn new(gpu: &Gpu, plan: &Plan) -> Result<Self, Diagnostics> {
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
        let mut uniforms =
            Self { places, outside, regions, bytes, sent, is_stale: true, buffer, staging: None, staged };
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
        self.pack_live(plan, None, &|name| known.live_value(name), &|name| live(name, None))?;
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
            self.pack_live(plan, Some(info.steps), &|_| None, &|name| live(name, Some(info)))?;
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

    fn pack_live<'v>(
        &mut self,
        plan: &Plan,
        steps: Option<usize>,
        known: &dyn Fn(&str) -> Option<&'v Value>,
        live: &dyn Fn(&str) -> Option<Value>,
    ) -> Result<(), Diagnostics> {
        let either = |name: &str| known(name).cloned().or_else(|| live(name));
        let mut found = Diagnostics::new();
        for place in self.places.iter().filter(|p| p.live && p.steps == steps) {
            for member in &plan.uniforms[place.block].members {
                let UniformValue::Live(expr) = &member.value else { continue };
                let told = match &expr.kind {
                    ExprKind::Name(name) => known(name),
                    _ => None,
                };
                let packed = match told.map(Cow::Borrowed).or_else(|| eval_live(expr, &either).map(Cow::Owned)) {
                    Some(value) => pack(&mut self.bytes, place, plan, member, &value),
                    None => Err(Diagnostic::error(
                        Code::MISSING_INPUT,
                        format!("nothing gives `{}` of `{}` a value", member.name, plan.passes[place.pass].path),
                    )
                    .at(expr.span, "asked for here")),
                };
                if let Err(diagnostic) = packed {
                    found.push(diagnostic);
                }
            }
        }
        if found.is_empty() { Ok(()) } else { Err(found) }
    }
}

fn span(region: &Range<u64>) -> Range<usize> {
    region.start as usize..region.end as usize
}

fn pack(bytes: &mut [u8], place: &Place, plan: &Plan, member: &UniformMember, value: &Value) -> Result<(), Diagnostic> {
    let block = &plan.uniforms[place.block];
    let (start, end) = (place.offset as usize, place.offset as usize + block.size.max(16) as usize);
    let out = bytes.get_mut(start + member.offset as usize..end).unwrap_or_default();
    packing::encode(value, &member.ty, out).map_err(|message| {
        let pass = &plan.passes[place.pass];
        Diagnostic::error(Code::UNIFORM_MISMATCH, format!("`{}` of `{}`: {message}", member.name, pass.path))
            .at(pass.span, "packed for this pass")
    })
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
