//! What a pass needs at hand to be encoded: bind groups and views. Made once for each rotation
//! of the state that it touches, and kept: a warm frame makes nothing.

use wgpu::util::DeviceExt as _;
use wgpu_types::{TextureAspect, TextureFormat};

use super::clear::{self, ClearVariant};
use super::convert;
use super::draws::DrawVariant;
use super::gpu::Gpu;
use super::materials::Materials;
use super::meshes::ByFaces;
use super::mips::{self, MipStep};
use super::pipeline::{Pipeline, PipelineKind};
use super::pool::Pool;
use super::uniform::Uniforms;
use crate::format::SampleKind;
use crate::plan::model::{
    Argument, ArgumentKind, Binding, Bound, Dispatch, ObjectId, ObjectKind, ObjectRef, Pass, PassKind, Plan, View,
};
use crate::shader::reflect::TextureDimension;

/// A pass made ready, for one rotation of its rings. What is looked at in every frame lies here
/// together: between two frames the processor's caches belong to others.
#[derive(Debug)]
pub(super) enum Variant {
    /// A pass's, or one that settles a counted buffer.
    Dispatch(DispatchVariant),
    Draw(DrawVariant),
    Clear(ClearVariant),
    Mips(Vec<MipStep>),
    /// Copies name what they touch as they go.
    Nothing,
}

#[derive(Debug)]
pub(super) struct DispatchVariant {
    pub pipeline: wgpu::ComputePipeline,
    pub group: Option<wgpu::BindGroup>,
    pub dispatch: Dispatch,
}

/// What does not change between variants.
#[derive(Debug)]
pub(super) struct Fixed {
    pub samplers: Vec<wgpu::Sampler>,
    /// 32 bytes to a slot.
    pub arguments: wgpu::Buffer,
    /// The largest raw count of each settling pass, in the order of the plan.
    pub stats: wgpu::Buffer,
}

/// Everything that variants are made from.
#[derive(Clone, Copy)]
pub(super) struct Bench<'a> {
    pub gpu: &'a Gpu,
    pub plan: &'a Plan,
    pub pool: &'a Pool,
    pub uniforms: &'a Uniforms,
    pub fixed: &'a Fixed,
    pub rotation: &'a [usize],
    pub materials: &'a Materials,
    /// Of each pass, by index.
    pub by_faces: &'a [Option<ByFaces>],
}

impl Fixed {
    pub fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let settles = plan.passes.iter().filter(|p| matches!(p.kind, PassKind::Settle { .. })).count() as u64;
        let buffer = |label, size: u64, usage| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        // Copied from where a plan comes after another.
        let all = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        Self {
            samplers: plan.samplers.iter().map(|s| gpu.device().create_sampler(&convert::sampler(s))).collect(),
            arguments: buffer(
                "arguments",
                u64::from(plan.argument_slots.max(1)) * 32,
                all | wgpu::BufferUsages::INDIRECT,
            ),
            stats: buffer("counts", settles.max(1) * 4, all),
        }
    }
}

/// The object that a reference stands for now.
pub(super) fn resolve(plan: &Plan, rotation: &[usize], object: ObjectRef) -> ObjectId {
    match object {
        ObjectRef::Fixed(id) => id,
        ObjectRef::Ring { ring, index } => {
            let objects = &plan.rings[ring].objects;
            objects[(index + rotation[ring]) % objects.len()]
        }
    }
}

/// Every reference that a pass makes.
pub(super) fn references(pass: &Pass) -> Vec<ObjectRef> {
    let mut found = Vec::new();
    let bindings: &[Binding] = match &pass.kind {
        PassKind::Compute { shader, .. } => &shader.bindings,
        PassKind::Draw(draw) => {
            for target in &draw.color {
                found.push(target.view.object);
                found.extend(target.resolve.as_ref().map(|v| v.object));
            }
            found.extend(draw.depth.as_ref().map(|d| d.view.object));
            found.extend(draw.geometry.buffers());
            &draw.shader.bindings
        }
        PassKind::Clear { view, .. } => {
            found.push(view.object);
            &[]
        }
        PassKind::Copy { from, to } => {
            found.extend([from.object, to.object]);
            &[]
        }
        PassKind::Mips { texture: object }
        | PassKind::Settle { counted: object, .. }
        | PassKind::Arguments { from: object, .. } => {
            found.push(*object);
            &[]
        }
    };
    found.extend(bindings.iter().filter_map(|b| match &b.bound {
        Bound::UniformBuffer { buffer } | Bound::Storage { buffer, .. } | Bound::Material { buffer, .. } => {
            Some(*buffer)
        }
        Bound::Texture { view, .. } | Bound::StorageTexture { view, .. } => Some(view.object),
        Bound::Uniform { .. }
        | Bound::Sampler { .. }
        | Bound::MaterialTexture { .. }
        | Bound::MaterialSampler { .. } => None,
    }));
    found
}

impl Bench<'_> {
    pub fn object(&self, object: ObjectRef) -> ObjectId {
        resolve(self.plan, self.rotation, object)
    }

    /// # Errors
    /// A message if the plan refers to something that is not there; what wgpu refuses goes to
    /// the scope around.
    pub fn variant(&self, index: usize, pipeline: Option<&Pipeline>) -> Result<Variant, String> {
        let pass = &self.plan.passes[index];
        match &pass.kind {
            PassKind::Compute { shader, dispatch } => {
                let group = self.group(pass, pipeline, &shader.bindings, 0)?;
                Ok(Variant::Dispatch(dispatched(pipeline, group, dispatch.clone())?))
            }
            PassKind::Draw(draw) => Ok(Variant::Draw(self.draw(index, pass, pipeline, draw)?)),
            PassKind::Clear { view, value } => clear::variant(self, pass, pipeline, view, *value).map(Variant::Clear),
            PassKind::Mips { texture } => mips::variant(self, pass, pipeline, *texture).map(Variant::Mips),
            PassKind::Settle { counted, arguments } => {
                let group = self.settle(index, pipeline, (*counted, arguments), pass.steps.is_some())?;
                Ok(Variant::Dispatch(dispatched(pipeline, Some(group), Dispatch::Groups([1; 3]))?))
            }
            PassKind::Copy { .. } | PassKind::Arguments { .. } => Ok(Variant::Nothing),
        }
    }

    pub fn texture(&self, object: ObjectRef) -> Result<&wgpu::Texture, String> {
        let id = self.object(object);
        self.pool.texture(id).ok_or_else(|| format!("`{}` is no texture", self.plan.objects[id].path))
    }

    pub fn buffer(&self, object: ObjectRef) -> Result<&wgpu::Buffer, String> {
        let id = self.object(object);
        self.pool.buffer(id).ok_or_else(|| format!("`{}` is no buffer", self.plan.objects[id].path))
    }

    /// A view of one layer of one mip, to draw into.
    pub fn attachment(&self, view: &View) -> Result<wgpu::TextureView, String> {
        Ok(layer_view(self.texture(view.object)?, view.mips.start, view.layers.start))
    }

    fn sampled(&self, view: &View, sample: SampleKind) -> Result<wgpu::TextureView, String> {
        let texture = self.texture(view.object)?;
        let aspect = match sample {
            SampleKind::Uint if texture.format().has_stencil_aspect() => TextureAspect::StencilOnly,
            _ if texture.format().has_depth_aspect() => TextureAspect::DepthOnly,
            _ => TextureAspect::All,
        };
        Ok(view_of(texture, view, aspect))
    }

    /// The exact range of a buffer.
    pub fn whole(&self, object: ObjectRef) -> Result<wgpu::BindingResource<'_>, String> {
        let buffer = self.buffer(object)?;
        let bytes = match &self.plan.objects[self.object(object)].kind {
            ObjectKind::Buffer(b) => b.bytes(),
            ObjectKind::Texture(_) => 0,
        };
        Ok(wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer,
            offset: 0,
            size: wgpu::BufferSize::new(bytes.min(buffer.size())),
        }))
    }

    /// The bind group of a pass, or of one material of it.
    pub fn group(
        &self,
        pass: &Pass,
        pipeline: Option<&Pipeline>,
        bindings: &[Binding],
        material: u32,
    ) -> Result<Option<wgpu::BindGroup>, String> {
        let Some(layout) = pipeline.and_then(|p| p.layout.as_ref()) else { return Ok(None) };
        // Views first, since entries borrow them.
        let views = bindings.iter().map(|b| match &b.bound {
            Bound::Texture { view, sample, .. } => self.sampled(view, *sample).map(Some),
            Bound::StorageTexture { view, .. } => {
                Ok(Some(view_of(self.texture(view.object)?, view, TextureAspect::All)))
            }
            _ => Ok(None),
        });
        let views = views.collect::<Result<Vec<_>, String>>()?;
        let entries = bindings.iter().zip(&views).map(|(binding, view)| {
            let resource = match view {
                Some(view) => wgpu::BindingResource::TextureView(view),
                None => self.resource(pass, &binding.bound, material)?,
            };
            Ok(wgpu::BindGroupEntry { binding: binding.binding, resource })
        });
        let entries = entries.collect::<Result<Vec<_>, String>>()?;
        Ok(Some(self.make_group(&pass.path, layout, &entries)))
    }

    fn resource(&self, pass: &Pass, bound: &Bound, material: u32) -> Result<wgpu::BindingResource<'_>, String> {
        match bound {
            Bound::Uniform { block } => self
                .uniforms
                .binding(self.plan, pass, *block)
                .map(wgpu::BindingResource::Buffer)
                .ok_or_else(|| format!("uniform block {block} has no place")),
            Bound::UniformBuffer { buffer } | Bound::Storage { buffer, .. } => self.whole(*buffer),
            Bound::Sampler { sampler } => self
                .fixed
                .samplers
                .get(*sampler)
                .map(wgpu::BindingResource::Sampler)
                .ok_or_else(|| format!("there is no sampler {sampler}")),
            Bound::Material { buffer, bytes } => self.material(*buffer, *bytes, material),
            Bound::MaterialTexture { input, texture } => {
                self.materials.texture(input, material, *texture).map(wgpu::BindingResource::TextureView)
            }
            Bound::MaterialSampler { input, texture } => {
                self.materials.sampler(input, material, *texture).map(wgpu::BindingResource::Sampler)
            }
            Bound::Texture { .. } | Bound::StorageTexture { .. } => Err("a texture without a view".into()),
        }
    }

    /// One item of a buffer of materials.
    fn material(&self, buffer: ObjectRef, bytes: u32, material: u32) -> Result<wgpu::BindingResource<'_>, String> {
        let stride = match &self.plan.objects[self.object(buffer)].kind {
            ObjectKind::Buffer(b) => u64::from(b.stride),
            ObjectKind::Texture(_) => 0,
        };
        Ok(wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.buffer(buffer)?,
            offset: u64::from(material) * stride,
            size: wgpu::BufferSize::new(u64::from(bytes)),
        }))
    }

    pub fn make_group(
        &self,
        label: &str,
        layout: &wgpu::BindGroupLayout,
        entries: &[wgpu::BindGroupEntry<'_>],
    ) -> wgpu::BindGroup {
        self.gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries })
    }

    /// A small buffer that is never written again.
    pub fn constant(&self, label: &str, words: &[u32], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let contents = bytemuck::cast_slice(words);
        self.gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
    }

    /// What settles a count once more, whose largest raw value is known.
    ///
    /// # Errors
    /// As [`Bench::variant`].
    pub fn settled_again(&self, index: usize, pipeline: Option<&Pipeline>) -> Result<DispatchVariant, String> {
        let PassKind::Settle { counted, arguments } = &self.plan.passes[index].kind else {
            return Err("it settles nothing".into());
        };
        let group = self.settle(index, pipeline, (*counted, arguments), true)?;
        dispatched(pipeline, Some(group), Dispatch::Groups([1; 3]))
    }

    fn settle(
        &self,
        index: usize,
        pipeline: Option<&Pipeline>,
        (counted, arguments): (ObjectRef, &[Argument]),
        runs_again: bool,
    ) -> Result<wgpu::BindGroup, String> {
        let layout = pipeline.and_then(|p| p.layout.as_ref()).ok_or("the settling kernel has no layout")?;
        let capacity = match &self.plan.objects[self.object(counted)].kind {
            ObjectKind::Buffer(b) => u32::try_from(b.items).unwrap_or(u32::MAX),
            ObjectKind::Texture(_) => 0,
        };
        let path = &self.plan.passes[index].path;
        let words = [capacity, stat_of(self.plan, index) as u32, arguments.len() as u32, u32::from(runs_again)];
        let settle = self.constant(path, &words, wgpu::BufferUsages::UNIFORM);
        let mut consumers: Vec<u32> = arguments.iter().flat_map(consumer).collect();
        // A storage buffer holds one item at least.
        consumers.resize(consumers.len().max(4), 0);
        let consumers = self.constant(path, &consumers, wgpu::BufferUsages::STORAGE);
        let resources = [
            self.whole(counted)?,
            self.fixed.arguments.as_entire_binding(),
            self.fixed.stats.as_entire_binding(),
            settle.as_entire_binding(),
            consumers.as_entire_binding(),
        ];
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, r)| wgpu::BindGroupEntry { binding, resource: r }).collect();
        Ok(self.make_group(path, layout, &entries))
    }
}

fn dispatched(
    pipeline: Option<&Pipeline>,
    group: Option<wgpu::BindGroup>,
    dispatch: Dispatch,
) -> Result<DispatchVariant, String> {
    match pipeline.map(|p| &p.kind) {
        Some(PipelineKind::Compute(pipeline)) => Ok(DispatchVariant { pipeline: pipeline.clone(), group, dispatch }),
        _ => Err("it has no compute pipeline".into()),
    }
}

/// The place of a settling pass among its like.
pub(super) fn stat_of(plan: &Plan, index: usize) -> usize {
    plan.passes[..index].iter().filter(|p| matches!(p.kind, PassKind::Settle { .. })).count()
}

/// As the settling kernel reads it.
fn consumer(argument: &Argument) -> [u32; 4] {
    match argument.kind {
        ArgumentKind::Dispatch { threads } => [argument.slot, 0, threads.max(1), 0],
        ArgumentKind::Draw { vertices, instances, indexed } => {
            [argument.slot, 1 + u32::from(indexed), vertices.unwrap_or(u32::MAX), instances.unwrap_or(u32::MAX)]
        }
    }
}

/// A view of one layer of one mip of a 2D texture.
pub(super) fn layer_view(texture: &wgpu::Texture, mip: u32, layer: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_mip_level: mip,
        mip_level_count: Some(1),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..wgpu::TextureViewDescriptor::default()
    })
}

fn view_of(texture: &wgpu::Texture, view: &View, aspect: TextureAspect) -> wgpu::TextureView {
    let volume = view.dimension == TextureDimension::D3;
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(convert::view_dimension(view.dimension)),
        aspect,
        base_mip_level: view.mips.start,
        mip_level_count: Some(view.mips.len() as u32),
        base_array_layer: if volume { 0 } else { view.layers.start },
        array_layer_count: (!volume).then_some(view.layers.len() as u32),
        ..wgpu::TextureViewDescriptor::default()
    })
}

/// Whether depth of the format has to be drawn into a float target to be read back.
pub(super) fn depth_needs_draw(format: TextureFormat) -> bool {
    matches!(format, TextureFormat::Depth24Plus | TextureFormat::Depth24PlusStencil8)
}
