//! Shader modules and pipelines, each made once for all that defines it. What a reload leaves
//! as it was is found again here and not compiled anew.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use wgpu_types as wgt;

use super::gpu::Gpu;
use crate::shader::reflect::Module;

/// WGSL that the engine brings, or a module of the plan.
#[derive(Clone, Debug)]
pub(super) enum Source {
    Module(Arc<Module>),
    Text(Cow<'static, str>),
}

impl Source {
    fn hash(&self) -> u128 {
        match self {
            Source::Module(module) => module.hash,
            Source::Text(text) => twox_hash::XxHash3_128::oneshot(text.as_bytes()),
        }
    }
}

/// An entry point with its constants.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    pub source: Source,
    pub entry: String,
    pub constants: Vec<(String, f64)>,
}

impl Stage {
    pub fn text(text: impl Into<Cow<'static, str>>, entry: &str) -> Self {
        Self { source: Source::Text(text.into()), entry: entry.into(), constants: Vec::new() }
    }

    fn key(&self) -> StageKey {
        StageKey {
            module: self.source.hash(),
            entry: self.entry.clone(),
            constants: self.constants.iter().map(|(k, v)| (k.clone(), v.to_bits())).collect(),
        }
    }

    fn constants(&self) -> Vec<(&str, f64)> {
        self.constants.iter().map(|(k, v)| (k.as_str(), *v)).collect()
    }
}

/// All that defines a pipeline.
#[derive(Clone, Debug)]
pub(super) struct Recipe {
    pub layout: Vec<wgt::BindGroupLayoutEntry>,
    pub kind: RecipeKind,
}

#[derive(Clone, Debug)]
pub(super) enum RecipeKind {
    Compute(Stage),
    Draw {
        vertex: Stage,
        fragment: Option<Stage>,
        vertices: Vec<VertexSlot>,
        targets: Vec<Option<wgt::ColorTargetState>>,
        primitive: wgt::PrimitiveState,
        depth: Option<Box<wgt::DepthStencilState>>,
        samples: u32,
    },
}

/// A vertex buffer with one attribute.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct VertexSlot {
    pub stride: u64,
    pub step: wgt::VertexStepMode,
    pub format: wgt::VertexFormat,
    pub location: u32,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct StageKey {
    module: u128,
    entry: String,
    constants: Vec<(String, u64)>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    layout: Vec<wgt::BindGroupLayoutEntry>,
    stages: Vec<StageKey>,
    draw: Option<DrawKey>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct DrawKey {
    vertices: Vec<VertexSlot>,
    targets: Vec<Option<wgt::ColorTargetState>>,
    primitive: wgt::PrimitiveState,
    depth: Option<Box<wgt::DepthStencilState>>,
    samples: u32,
}

impl Recipe {
    fn key(&self) -> Key {
        let layout = self.layout.clone();
        match &self.kind {
            RecipeKind::Compute(stage) => Key { layout, stages: vec![stage.key()], draw: None },
            RecipeKind::Draw { vertex, fragment, vertices, targets, primitive, depth, samples } => Key {
                layout,
                stages: std::iter::once(vertex).chain(fragment).map(Stage::key).collect(),
                draw: Some(DrawKey {
                    vertices: vertices.clone(),
                    targets: targets.clone(),
                    primitive: *primitive,
                    depth: depth.clone(),
                    samples: *samples,
                }),
            },
        }
    }
}

/// A pipeline and the layout of its bind group 0, if it binds anything.
#[derive(Debug)]
pub(super) struct Pipeline {
    pub kind: PipelineKind,
    pub layout: Option<wgpu::BindGroupLayout>,
}

#[derive(Debug)]
pub(super) enum PipelineKind {
    Compute(wgpu::ComputePipeline),
    Draw(wgpu::RenderPipeline),
}

#[derive(Debug)]
struct Kept<T> {
    value: T,
    /// The round in which it was last asked for.
    used: u64,
}

/// Modules, layouts and pipelines by content.
#[derive(Debug, Default)]
pub(super) struct PipelineCache {
    modules: HashMap<u128, Kept<wgpu::ShaderModule>>,
    layouts: HashMap<Vec<wgt::BindGroupLayoutEntry>, wgpu::BindGroupLayout>,
    pipelines: HashMap<Key, Kept<Arc<Pipeline>>>,
    round: u64,
}

/// How many preparations a pipeline outlives its last use: going back to an earlier text while
/// editing is then free.
const KEPT_ROUNDS: u64 = 64;

impl PipelineCache {
    /// Lets go of what has long been out of use.
    pub fn begin_round(&mut self) {
        self.round += 1;
        let oldest = self.round.saturating_sub(KEPT_ROUNDS);
        self.modules.retain(|_, kept| kept.used >= oldest);
        self.pipelines.retain(|_, kept| kept.used >= oldest);
    }

    fn find(&mut self, key: &Key) -> Option<Arc<Pipeline>> {
        let kept = self.pipelines.get_mut(key)?;
        kept.used = self.round;
        Some(Arc::clone(&kept.value))
    }

    /// Forgets what a recipe made: it is invalid.
    pub fn forget(&mut self, recipe: &Recipe) {
        self.pipelines.remove(&recipe.key());
        self.layouts.remove(&recipe.layout);
        let stages: Vec<&Stage> = match &recipe.kind {
            RecipeKind::Compute(stage) => vec![stage],
            RecipeKind::Draw { vertex, fragment, .. } => std::iter::once(vertex).chain(fragment).collect(),
        };
        for stage in stages {
            self.modules.remove(&stage.source.hash());
        }
    }
}

/// The cache for several threads. Its lock is never held while something is made: who draws does not wait
/// for what another thread has the driver compile.
#[derive(Debug, Default)]
pub(super) struct Shelf(Mutex<PipelineCache>);

impl Shelf {
    pub fn cache(&self) -> MutexGuard<'_, PipelineCache> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The pipeline of a recipe, found or made now, and whether it is new. To be called inside error
    /// scopes; what is made inside a scope that catches an error must be forgotten with
    /// [`PipelineCache::forget`].
    pub fn get(&self, gpu: &Gpu, recipe: &Recipe, label: &str) -> (Arc<Pipeline>, bool) {
        let key = recipe.key();
        if let Some(known) = self.cache().find(&key) {
            return (known, false);
        }
        let pipeline = Arc::new(self.build(gpu, recipe, label));
        let mut cache = self.cache();
        let kept = Kept { value: Arc::clone(&pipeline), used: cache.round };
        cache.pipelines.insert(key, kept);
        (pipeline, true)
    }

    fn build(&self, gpu: &Gpu, recipe: &Recipe, label: &str) -> Pipeline {
        let layout = (!recipe.layout.is_empty()).then(|| self.bind_group_layout(gpu, &recipe.layout));
        let groups: Vec<_> = layout.iter().map(Some).collect();
        let pipeline_layout = gpu.device().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let kind = match &recipe.kind {
            RecipeKind::Compute(stage) => {
                let module = self.module(gpu, &stage.source);
                PipelineKind::Compute(gpu.device().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(label),
                    layout: Some(&pipeline_layout),
                    module: &module,
                    entry_point: Some(&stage.entry),
                    compilation_options: options(&stage.constants()),
                    cache: None,
                }))
            }
            RecipeKind::Draw { .. } => PipelineKind::Draw(self.draw(gpu, recipe, &pipeline_layout, label)),
        };
        Pipeline { kind, layout }
    }

    fn draw(&self, gpu: &Gpu, recipe: &Recipe, layout: &wgpu::PipelineLayout, label: &str) -> wgpu::RenderPipeline {
        let RecipeKind::Draw { vertex, fragment, vertices, targets, primitive, depth, samples } = &recipe.kind else {
            unreachable!("only called for draws")
        };
        let vertex_module = self.module(gpu, &vertex.source);
        let fragment_module = fragment.as_ref().map(|f| (self.module(gpu, &f.source), f, f.constants()));
        let attributes: Vec<_> = vertices
            .iter()
            .map(|v| [wgpu::VertexAttribute { format: v.format, offset: 0, shader_location: v.location }])
            .collect();
        let buffers: Vec<_> = vertices
            .iter()
            .zip(&attributes)
            .map(|(v, attributes)| {
                Some(wgpu::VertexBufferLayout { array_stride: v.stride, step_mode: v.step, attributes })
            })
            .collect();
        gpu.device().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module: &vertex_module,
                entry_point: Some(&vertex.entry),
                compilation_options: options(&vertex.constants()),
                buffers: &buffers,
            },
            primitive: *primitive,
            depth_stencil: depth.as_deref().cloned(),
            multisample: wgpu::MultisampleState { count: *samples, ..wgpu::MultisampleState::default() },
            fragment: fragment_module.as_ref().map(|(module, stage, constants)| wgpu::FragmentState {
                module,
                entry_point: Some(&stage.entry),
                compilation_options: options(constants),
                targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    fn bind_group_layout(&self, gpu: &Gpu, entries: &[wgt::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
        if let Some(layout) = self.cache().layouts.get(entries) {
            return layout.clone();
        }
        let layout = gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries });
        self.cache().layouts.insert(entries.to_vec(), layout.clone());
        layout
    }

    fn module(&self, gpu: &Gpu, source: &Source) -> wgpu::ShaderModule {
        let hash = source.hash();
        {
            let mut cache = self.cache();
            let round = cache.round;
            if let Some(kept) = cache.modules.get_mut(&hash) {
                kept.used = round;
                return kept.value.clone();
            }
        }
        let (label, source) = match source {
            Source::Module(m) => (m.path.to_str(), wgpu::ShaderSource::Naga(Cow::Owned(naga::Module::clone(&m.naga)))),
            Source::Text(text) => (Some("engine"), wgpu::ShaderSource::Wgsl(text.clone())),
        };
        let value = gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor { label, source });
        let mut cache = self.cache();
        let kept = Kept { value: value.clone(), used: cache.round };
        cache.modules.insert(hash, kept);
        value
    }
}

fn options<'a>(constants: &'a [(&'a str, f64)]) -> wgpu::PipelineCompilationOptions<'a> {
    wgpu::PipelineCompilationOptions { constants, ..wgpu::PipelineCompilationOptions::default() }
}
