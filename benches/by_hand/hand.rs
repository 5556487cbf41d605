//! A frame written by hand: straight wgpu, everything made once, then passes one after the other.
//! Sizes, shader modules and the order of passes are taken from the plan, so that both sides do
//! the same; nothing of the engine is.

use std::borrow::Cow;
use std::collections::HashMap;

use meniscus::graph::eval::eval_live;
use meniscus::graph::model::{Compare, Face, Factor, Operation, Topology};
use meniscus::graph::value::Value;
use meniscus::plan::model::*;
use meniscus::plan::packing;
use meniscus::shader::reflect::TextureDimension;
use wgpu::util::DeviceExt as _;

const FULLSCREEN: &str = include_str!("../../src/engine/kernels/fullscreen.wgsl");
const SETTLE: &str = include_str!("../../src/engine/kernels/settle.wgsl");

enum Memory {
    Texture(wgpu::Texture),
    Buffer(wgpu::Buffer),
}

enum Work {
    Groups([u32; 3]),
    Indirect(u64),
}

struct Compute {
    label: String,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    work: Work,
}

enum Vertices {
    Direct(u32, u32),
    Indirect(u64),
}

struct Target {
    view: wgpu::TextureView,
    resolve: Option<wgpu::TextureView>,
    load: wgpu::LoadOp<wgpu::Color>,
}

struct Drawing {
    label: String,
    /// Absent for meshes: the scene has none, and only their targets are cleared.
    pipeline: Option<wgpu::RenderPipeline>,
    group: Option<wgpu::BindGroup>,
    colors: Vec<Target>,
    depth: Option<(wgpu::TextureView, Option<wgpu::Operations<f32>>)>,
    vertices: Vertices,
}

enum Step {
    Compute(Compute),
    Draw(Drawing),
    Zero(wgpu::Buffer, u64),
}

/// How the hand that wrote it went about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// A pass of wgpu's for each pass, as one writes it down.
    Plain,
    /// Dispatches that follow each other share a pass, and nothing bears a name.
    Careful,
}

pub struct Hand {
    steps: Vec<Step>,
    uniforms: wgpu::Buffer,
    arguments: wgpu::Buffer,
    memory: Vec<Memory>,
}

/// Milliseconds of recording a frame up to its submission, and of submitting it.
pub struct Took {
    pub encode_ms: f64,
    pub submit_ms: f64,
}

impl Hand {
    /// Everything that the frames of a plan need.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, plan: &Plan, positions: &[u8]) -> Self {
        let memory: Vec<Memory> = plan.objects.iter().map(|object| memory(device, queue, object, positions)).collect();
        let (_, size) = places(plan);
        let buffer = |label, size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
        };
        let uniforms = buffer("uniforms", size.max(256), wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST);
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT;
        let arguments = buffer("arguments", u64::from(plan.argument_slots.max(1)) * 32, usage);
        let mut hand = Self { steps: Vec::new(), uniforms, arguments, memory };
        let mut modules = Modules { device, plan, made: HashMap::new(), pipelines: HashMap::new() };
        hand.steps = plan.passes.iter().map(|pass| hand.step(&mut modules, pass)).collect();
        hand
    }

    pub fn buffer(&self, object: ObjectId) -> &wgpu::Buffer {
        match &self.memory[object] {
            Memory::Buffer(buffer) => buffer,
            Memory::Texture(_) => panic!("no buffer"),
        }
    }

    pub fn texture(&self, object: ObjectId) -> &wgpu::Texture {
        match &self.memory[object] {
            Memory::Texture(texture) => texture,
            Memory::Buffer(_) => panic!("no texture"),
        }
    }

    /// A frame.
    pub fn frame(&self, device: &wgpu::Device, queue: &wgpu::Queue, uniforms: &[u8], way: Way) -> Took {
        let began = std::time::Instant::now();
        if !uniforms.is_empty() {
            queue.write_buffer(&self.uniforms, 0, uniforms);
        }
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        let together =
            |a: &Step, b: &Step| way == Way::Careful && matches!((a, b), (Step::Compute(_), Step::Compute(_)));
        for steps in self.steps.chunk_by(together) {
            match &steps[0] {
                Step::Compute(first) => {
                    let label = (way == Way::Plain).then_some(first.label.as_str());
                    let mut pass =
                        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes: None });
                    for step in steps {
                        if let Step::Compute(compute) = step {
                            self.dispatch(&mut pass, compute);
                        }
                    }
                }
                Step::Draw(drawing) => self.draw(&mut encoder, drawing, way),
                Step::Zero(buffer, bytes) => encoder.clear_buffer(buffer, 0, Some(*bytes)),
            }
        }
        let commands = encoder.finish();
        let encode_ms = began.elapsed().as_secs_f64() * 1e3;
        let began = std::time::Instant::now();
        queue.submit([commands]);
        Took { encode_ms, submit_ms: began.elapsed().as_secs_f64() * 1e3 }
    }

    fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, compute: &Compute) {
        pass.set_pipeline(&compute.pipeline);
        pass.set_bind_group(0, &compute.group, &[]);
        match compute.work {
            Work::Groups([x, y, z]) => pass.dispatch_workgroups(x, y, z),
            Work::Indirect(at) => pass.dispatch_workgroups_indirect(&self.arguments, at),
        }
    }

    fn draw(&self, encoder: &mut wgpu::CommandEncoder, drawing: &Drawing, way: Way) {
        let colors: Vec<_> = drawing
            .colors
            .iter()
            .map(|target| {
                Some(wgpu::RenderPassColorAttachment {
                    view: &target.view,
                    depth_slice: None,
                    resolve_target: target.resolve.as_ref(),
                    ops: wgpu::Operations { load: target.load, store: wgpu::StoreOp::Store },
                })
            })
            .collect();
        let depth = drawing.depth.as_ref().map(|(view, ops)| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: *ops,
            stencil_ops: None,
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: (way == Way::Plain).then_some(drawing.label.as_str()),
            color_attachments: &colors,
            depth_stencil_attachment: depth,
            ..wgpu::RenderPassDescriptor::default()
        });
        let Some(pipeline) = &drawing.pipeline else { return };
        pass.set_pipeline(pipeline);
        if let Some(group) = &drawing.group {
            pass.set_bind_group(0, group, &[]);
        }
        match drawing.vertices {
            Vertices::Direct(vertices, instances) => pass.draw(0..vertices, 0..instances),
            Vertices::Indirect(at) => pass.draw_indirect(&self.arguments, at),
        }
    }

    fn step(&self, modules: &mut Modules<'_>, pass: &Pass) -> Step {
        match &pass.kind {
            PassKind::Compute { shader, dispatch } => {
                let pipeline = modules.compute(shader);
                let group = self.group(modules, &pipeline.get_bind_group_layout(0), &shader.bindings);
                let work = match dispatch {
                    Dispatch::Groups(groups) => Work::Groups(*groups),
                    Dispatch::Indirect { slot } => Work::Indirect(u64::from(*slot) * 32),
                };
                Step::Compute(Compute { label: pass.path.clone(), pipeline, group, work })
            }
            PassKind::Settle { counted, arguments } => Step::Compute(self.settle(modules, pass, *counted, arguments)),
            PassKind::Draw(draw) => Step::Draw(self.drawing(modules, pass, draw)),
            PassKind::Clear { view, value } if value[0] == 0.0 => {
                let id = fixed(view.object);
                let ObjectKind::Buffer(about) = &modules.plan.objects[id].kind else {
                    panic!("only buffers are cleared")
                };
                Step::Zero(self.buffer(id).clone(), if about.counted { 4 } else { about.bytes() })
            }
            other => panic!("not written by hand: {other:?}"),
        }
    }

    fn view(&self, view: &View) -> wgpu::TextureView {
        let texture = self.texture(fixed(view.object));
        let volume = view.dimension == TextureDimension::D3;
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(match view.dimension {
                TextureDimension::D1 => wgpu::TextureViewDimension::D1,
                TextureDimension::D2 => wgpu::TextureViewDimension::D2,
                TextureDimension::D2Array => wgpu::TextureViewDimension::D2Array,
                TextureDimension::Cube => wgpu::TextureViewDimension::Cube,
                TextureDimension::CubeArray => wgpu::TextureViewDimension::CubeArray,
                TextureDimension::D3 => wgpu::TextureViewDimension::D3,
            }),
            base_mip_level: view.mips.start,
            mip_level_count: Some(view.mips.len() as u32),
            base_array_layer: if volume { 0 } else { view.layers.start },
            array_layer_count: (!volume).then_some(view.layers.len() as u32),
            ..wgpu::TextureViewDescriptor::default()
        })
    }

    fn target(&self, view: &View) -> wgpu::TextureView {
        self.texture(fixed(view.object)).create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_mip_level: view.mips.start,
            mip_level_count: Some(1),
            base_array_layer: view.layers.start,
            array_layer_count: Some(1),
            ..wgpu::TextureViewDescriptor::default()
        })
    }

    fn group(&self, modules: &Modules<'_>, layout: &wgpu::BindGroupLayout, bindings: &[Binding]) -> wgpu::BindGroup {
        let plan = modules.plan;
        let (places, _) = places(plan);
        let views: Vec<_> = bindings
            .iter()
            .map(|b| match &b.bound {
                Bound::Texture { view, .. } | Bound::StorageTexture { view, .. } => Some(self.view(view)),
                _ => None,
            })
            .collect();
        let samplers: Vec<_> = bindings
            .iter()
            .map(|b| match &b.bound {
                Bound::Sampler { sampler } => Some(sampler_of(modules.device, &plan.samplers[*sampler])),
                _ => None,
            })
            .collect();
        let entries: Vec<_> = bindings
            .iter()
            .zip(views.iter().zip(&samplers))
            .map(|(binding, (view, sampler))| {
                let resource = match &binding.bound {
                    Bound::Uniform { block } => wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer: &self.uniforms,
                        offset: places[*block],
                        size: wgpu::BufferSize::new(u64::from(plan.uniforms[*block].size.max(16))),
                    }),
                    Bound::Storage { buffer, .. } | Bound::UniformBuffer { buffer } => {
                        self.buffer(fixed(*buffer)).as_entire_binding()
                    }
                    Bound::Sampler { .. } => wgpu::BindingResource::Sampler(sampler.as_ref().unwrap()),
                    _ => wgpu::BindingResource::TextureView(view.as_ref().unwrap()),
                };
                wgpu::BindGroupEntry { binding: binding.binding, resource }
            })
            .collect();
        modules.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    fn settle(&self, modules: &mut Modules<'_>, pass: &Pass, counted: ObjectRef, arguments: &[Argument]) -> Compute {
        let device = modules.device;
        let pipeline = modules.settle();
        let ObjectKind::Buffer(about) = &modules.plan.objects[fixed(counted)].kind else { panic!("no buffer") };
        let words = [about.items as u32, 0, arguments.len() as u32, 0];
        let mut consumers: Vec<u32> = arguments.iter().flat_map(consumer).collect();
        consumers.resize(consumers.len().max(4), 0);
        let constant = |words: &[u32], usage| {
            let contents = bytemuck::cast_slice(words);
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let settle = constant(&words, wgpu::BufferUsages::UNIFORM);
        let consumers = constant(&consumers, wgpu::BufferUsages::STORAGE);
        let stats = constant(&[0; 4], wgpu::BufferUsages::STORAGE);
        let buffers = [self.buffer(fixed(counted)), &self.arguments, &stats, &settle, &consumers];
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, b)| wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() })
            .collect();
        let layout = pipeline.get_bind_group_layout(0);
        let group =
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries });
        Compute { label: pass.path.clone(), pipeline, group, work: Work::Groups([1, 1, 1]) }
    }

    fn drawing(&self, modules: &mut Modules<'_>, pass: &Pass, draw: &Draw) -> Drawing {
        let pipeline = (!matches!(draw.geometry, Geometry::Meshes(_))).then(|| modules.draw(draw));
        let bound = pipeline.as_ref().filter(|_| !draw.shader.bindings.is_empty());
        let colors = draw.color.iter().map(|target| Target {
            view: self.target(&target.view),
            resolve: target.resolve.as_ref().map(|view| self.target(view)),
            load: match target.clear {
                Some([r, g, b, a]) => wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                None => wgpu::LoadOp::Load,
            },
        });
        let depth = draw.depth.as_ref().map(|depth| {
            let load = depth.clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
            let ops = (depth.write || depth.clear.is_some())
                .then_some(wgpu::Operations { load, store: wgpu::StoreOp::Store });
            (self.target(&depth.view), ops)
        });
        Drawing {
            label: pass.path.clone(),
            group: bound.map(|bound| self.group(modules, &bound.get_bind_group_layout(0), &draw.shader.bindings)),
            colors: colors.collect(),
            depth,
            vertices: match draw.geometry {
                Geometry::Fullscreen => Vertices::Direct(3, 1),
                Geometry::Direct { vertices, instances } => Vertices::Direct(vertices, instances),
                Geometry::Indirect { slot, indices: None } => Vertices::Indirect(u64::from(slot) * 32),
                Geometry::Meshes(_) => Vertices::Direct(0, 0),
                ref other => panic!("not written by hand: {other:?}"),
            },
            pipeline,
        }
    }
}

/// The bytes of all uniform blocks in a frame.
pub fn uniforms(plan: &Plan, live: &dyn Fn(&str) -> Option<Value>) -> Vec<u8> {
    let (places, size) = places(plan);
    let mut bytes = vec![0; size as usize];
    for (block, at) in plan.uniforms.iter().zip(places) {
        for member in &block.members {
            let value = match &member.value {
                UniformValue::Known(value) => value.clone(),
                UniformValue::Live(expr) => eval_live(expr, live).expect("a live value"),
            };
            packing::encode(&value, &member.ty, &mut bytes[at as usize + member.offset as usize..]).unwrap();
        }
    }
    bytes
}

/// Where each block lies, and the bytes of all.
fn places(plan: &Plan) -> (Vec<u64>, u64) {
    let mut end = 0;
    let places = plan.uniforms.iter().map(|block| {
        let at = end;
        end += u64::from(block.size.max(16)).next_multiple_of(256);
        at
    });
    (places.collect(), end)
}

fn fixed(object: ObjectRef) -> ObjectId {
    match object {
        ObjectRef::Fixed(id) => id,
        ObjectRef::Ring { .. } => panic!("state is not written by hand"),
    }
}

fn memory(device: &wgpu::Device, queue: &wgpu::Queue, object: &Object, positions: &[u8]) -> Memory {
    match &object.kind {
        ObjectKind::Texture(t) => Memory::Texture(device.create_texture(&wgpu::TextureDescriptor {
            label: Some(&object.path),
            size: wgpu::Extent3d { width: t.width, height: t.height, depth_or_array_layers: t.layers },
            mip_level_count: t.mips,
            sample_count: t.samples,
            dimension: if t.is_3d { wgpu::TextureDimension::D3 } else { wgpu::TextureDimension::D2 },
            format: t.format,
            usage: t.usages | if t.samples == 1 { wgpu::TextureUsages::COPY_SRC } else { wgpu::TextureUsages::empty() },
            view_formats: &[],
        })),
        ObjectKind::Buffer(b) => {
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(&object.path),
                size: b.bytes(),
                usage: b.usages
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            });
            if matches!(&object.origin, Origin::Attribute { attribute, .. } if attribute == "position") {
                queue.write_buffer(&buffer, 0, positions);
            }
            Memory::Buffer(buffer)
        }
    }
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

fn sampler_of(device: &wgpu::Device, sampler: &meniscus::graph::model::Sampler) -> wgpu::Sampler {
    use meniscus::graph::model::Address;
    let filter = if sampler.linear { wgpu::FilterMode::Linear } else { wgpu::FilterMode::Nearest };
    let address = match sampler.address {
        Address::Clamp => wgpu::AddressMode::ClampToEdge,
        Address::Repeat => wgpu::AddressMode::Repeat,
        Address::Mirror => wgpu::AddressMode::MirrorRepeat,
    };
    device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: address,
        address_mode_v: address,
        address_mode_w: address,
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter: if sampler.mip_linear {
            wgpu::MipmapFilterMode::Linear
        } else {
            wgpu::MipmapFilterMode::Nearest
        },
        compare: sampler.compare.map(compare),
        ..wgpu::SamplerDescriptor::default()
    })
}

fn compare(compare: Compare) -> wgpu::CompareFunction {
    match compare {
        Compare::Never => wgpu::CompareFunction::Never,
        Compare::Less => wgpu::CompareFunction::Less,
        Compare::Equal => wgpu::CompareFunction::Equal,
        Compare::LessEqual => wgpu::CompareFunction::LessEqual,
        Compare::Greater => wgpu::CompareFunction::Greater,
        Compare::NotEqual => wgpu::CompareFunction::NotEqual,
        Compare::GreaterEqual => wgpu::CompareFunction::GreaterEqual,
        Compare::Always => wgpu::CompareFunction::Always,
    }
}

fn blend(component: meniscus::graph::model::BlendComponent) -> wgpu::BlendComponent {
    let factor = |factor| match factor {
        Factor::Zero => wgpu::BlendFactor::Zero,
        Factor::One => wgpu::BlendFactor::One,
        Factor::SrcAlpha => wgpu::BlendFactor::SrcAlpha,
        Factor::OneMinusSrcAlpha => wgpu::BlendFactor::OneMinusSrcAlpha,
        other => panic!("not written by hand: {other:?}"),
    };
    assert!(matches!(component.operation, Operation::Add), "not written by hand");
    let (src_factor, dst_factor) = (factor(component.source), factor(component.target));
    wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add }
}

/// A module, an entry and its constants.
type Key = (usize, String, Vec<(String, u64)>);

/// Shader modules and pipelines, each made once.
struct Modules<'a> {
    device: &'a wgpu::Device,
    plan: &'a Plan,
    made: HashMap<usize, wgpu::ShaderModule>,
    /// By module, entry and constants: equal passes have one, as anybody would write it.
    pipelines: HashMap<Key, wgpu::ComputePipeline>,
}

impl Modules<'_> {
    fn module(&mut self, index: usize) -> wgpu::ShaderModule {
        let module = &self.plan.modules[index];
        let made = self.made.entry(index).or_insert_with(|| {
            let source = wgpu::ShaderSource::Naga(Cow::Owned((*module.naga).clone()));
            self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source })
        });
        made.clone()
    }

    fn text(&self, text: &'static str) -> wgpu::ShaderModule {
        let source = wgpu::ShaderSource::Wgsl(Cow::Borrowed(text));
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source })
    }

    fn settle(&self) -> wgpu::ComputePipeline {
        self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &self.text(SETTLE),
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        })
    }

    fn compute(&mut self, shader: &ShaderUse) -> wgpu::ComputePipeline {
        let constants = shader.constants.iter().map(|(name, value)| (name.clone(), value.to_bits())).collect();
        let key = (shader.module, shader.compute.clone().unwrap_or_default(), constants);
        if let Some(pipeline) = self.pipelines.get(&key) {
            return pipeline.clone();
        }
        let pipeline = self.new_compute(shader);
        self.pipelines.insert(key, pipeline.clone());
        pipeline
    }

    fn new_compute(&mut self, shader: &ShaderUse) -> wgpu::ComputePipeline {
        let module = self.module(shader.module);
        let constants: Vec<_> = shader.constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: shader.compute.as_deref(),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        })
    }

    fn draw(&mut self, draw: &Draw) -> wgpu::RenderPipeline {
        let module = self.module(draw.shader.module);
        let constants: Vec<_> = draw.shader.constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let options = || wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let fullscreen = draw.shader.vertex.is_none().then(|| self.text(FULLSCREEN));
        let targets: Vec<_> = draw
            .color
            .iter()
            .map(|target| {
                let blend = target.blend.map(|b| wgpu::BlendState { color: blend(b.color), alpha: blend(b.alpha) });
                assert_eq!(target.write, [true; 4], "not written by hand");
                Some(wgpu::ColorTargetState { format: target.format, blend, write_mask: wgpu::ColorWrites::ALL })
            })
            .collect();
        let depth_stencil = draw.depth.as_ref().map(|depth| wgpu::DepthStencilState {
            format: depth.format,
            depth_write_enabled: Some(depth.write),
            depth_compare: Some(compare(depth.compare)),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        });
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: fullscreen.as_ref().unwrap_or(&module),
                entry_point: draw.shader.vertex.as_deref().or(Some("fullscreen")),
                compilation_options: if fullscreen.is_some() { Default::default() } else { options() },
                buffers: &[],
            },
            primitive: primitive(draw),
            depth_stencil,
            multisample: wgpu::MultisampleState { count: draw.samples, ..Default::default() },
            fragment: draw.shader.fragment.as_deref().map(|entry| wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry),
                compilation_options: options(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn primitive(draw: &Draw) -> wgpu::PrimitiveState {
    wgpu::PrimitiveState {
        topology: match (&draw.geometry, draw.topology) {
            (Geometry::Fullscreen, _) | (_, Topology::TriangleList) => wgpu::PrimitiveTopology::TriangleList,
            (_, Topology::TriangleStrip) => wgpu::PrimitiveTopology::TriangleStrip,
            (_, other) => panic!("not written by hand: {other:?}"),
        },
        front_face: if draw.front_ccw { wgpu::FrontFace::Ccw } else { wgpu::FrontFace::Cw },
        cull_mode: draw.cull.filter(|_| draw.geometry != Geometry::Fullscreen).map(|face| match face {
            Face::Front => wgpu::Face::Front,
            Face::Back => wgpu::Face::Back,
        }),
        ..wgpu::PrimitiveState::default()
    }
}
