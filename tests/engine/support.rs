//! Plans made by hand, as the planner would make them.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use meniscus::diagnostic::{FileId, Sources, Span, Style, render_all};
use meniscus::engine::{Engine, Frame, Refused, Report, Runner};
use meniscus::files::MemoryFiles;
use meniscus::format::{TextureFormat, sample_kind};
use meniscus::graph::model::{Compare, Topology};
use meniscus::graph::value::Value;
use meniscus::plan::model::*;
use meniscus::shader::load;
use meniscus::shader::reflect::{GlobalKind, Scalar, TextureDimension, Type};
use wgpu_types::{BufferUsages, ShaderStages, TextureUsages};

pub const SPAN: Span = Span { file: FileId(0), start: 0, end: 0 };

pub fn new_plan() -> Plan {
    Plan {
        graph: PathBuf::from("test.ron"),
        viewport: [16, 16],
        modules: Vec::new(),
        objects: Vec::new(),
        uniforms: Vec::new(),
        samplers: Vec::new(),
        passes: Vec::new(),
        order: Order::default(),
        culled: Vec::new(),
        units: Vec::new(),
        rings: Vec::new(),
        steps: Vec::new(),
        outputs: Vec::new(),
        names: BTreeMap::new(),
        memory: Memory::default(),
        stats: Vec::new(),
        needs: Needs::default(),
        params: Vec::new(),
        structural: Default::default(),
        arithmetic: Default::default(),
        taken: BTreeMap::new(),
        argument_slots: 8,
        warnings: meniscus::diagnostic::Diagnostics::new(),
    }
}

/// Short ways to say what tests need often.
pub trait PlanExt {
    fn object(&mut self, path: &str, kind: ObjectKind) -> ObjectId;
    fn texture(&mut self, path: &str, format: TextureFormat, width: u32, height: u32) -> ObjectId;
    fn texture_as(&mut self, path: &str, texture: Texture) -> ObjectId;
    /// Items of one `u32`.
    fn buffer(&mut self, path: &str, items: u64) -> ObjectId;
    fn counted(&mut self, path: &str, capacity: u64) -> ObjectId;
    fn shader(&mut self, wgsl: &str) -> usize;
    fn pass(&mut self, path: &str, kind: PassKind) -> usize;
    fn compute(&mut self, path: &str, wgsl: &str, bound: &[(&str, Bound)], dispatch: Dispatch) -> usize;
    fn draw(&mut self, path: &str, wgsl: &str, bound: &[(&str, Bound)], geometry: Geometry) -> Draw;
    fn whole(&self, object: ObjectId) -> View;
}

impl PlanExt for Plan {
    fn object(&mut self, path: &str, kind: ObjectKind) -> ObjectId {
        self.objects.push(Object {
            path: path.into(),
            kind,
            origin: Origin::Frame,
            empty: None,
            lifetime: None,
            span: SPAN,
        });
        self.names.insert(path.into(), ObjectRef::Fixed(self.objects.len() - 1));
        self.objects.len() - 1
    }

    fn texture(&mut self, path: &str, format: TextureFormat, width: u32, height: u32) -> ObjectId {
        self.texture_as(path, texture(format, width, height))
    }

    fn texture_as(&mut self, path: &str, texture: Texture) -> ObjectId {
        self.object(path, ObjectKind::Texture(texture))
    }

    fn buffer(&mut self, path: &str, items: u64) -> ObjectId {
        let usages = BufferUsages::STORAGE | BufferUsages::INDEX;
        let item = Some(Type::Scalar(Scalar::U32));
        self.object(path, ObjectKind::Buffer(Buffer { stride: 4, items, header: 0, counted: false, item, usages }))
    }

    fn counted(&mut self, path: &str, capacity: u64) -> ObjectId {
        let usages = BufferUsages::STORAGE;
        let item = Some(Type::Scalar(Scalar::U32));
        self.object(
            path,
            ObjectKind::Buffer(Buffer { stride: 4, items: capacity, header: 4, counted: true, item, usages }),
        )
    }

    fn shader(&mut self, wgsl: &str) -> usize {
        let files = MemoryFiles::default().with("test.wgsl", wgsl);
        let mut sources = Sources::new();
        let loaded = load(&files, &mut sources, "test.wgsl", None);
        let module = loaded.module.unwrap_or_else(|| {
            panic!("{}", render_all(&loaded.diagnostics, &sources, Style::Plain));
        });
        self.modules.push(Arc::new(module));
        self.modules.len() - 1
    }

    fn pass(&mut self, path: &str, kind: PassKind) -> usize {
        self.passes.push(Pass {
            path: path.into(),
            span: SPAN,
            unit: 0,
            steps: None,
            kind,
            accesses: Vec::new(),
            unordered: false,
        });
        self.passes.len() - 1
    }

    fn compute(&mut self, path: &str, wgsl: &str, bound: &[(&str, Bound)], dispatch: Dispatch) -> usize {
        let module = self.shader(wgsl);
        let shader = ShaderUse {
            module,
            compute: Some("main".into()),
            vertex: None,
            fragment: None,
            constants: Vec::new(),
            bindings: bindings(self, module, bound, ShaderStages::COMPUTE),
        };
        self.pass(path, PassKind::Compute { shader, dispatch })
    }

    /// Entries `vs` (but for fullscreen) and `fs`.
    fn draw(&mut self, _path: &str, wgsl: &str, bound: &[(&str, Bound)], geometry: Geometry) -> Draw {
        let module = self.shader(wgsl);
        let fullscreen = geometry == Geometry::Fullscreen;
        let stages = if fullscreen { ShaderStages::FRAGMENT } else { ShaderStages::VERTEX_FRAGMENT };
        let has_fragment = self.modules[module].entries.iter().any(|e| e.name == "fs");
        Draw {
            shader: ShaderUse {
                module,
                compute: None,
                vertex: (!fullscreen).then(|| "vs".into()),
                fragment: has_fragment.then(|| "fs".into()),
                constants: Vec::new(),
                bindings: bindings(self, module, bound, stages),
            },
            geometry,
            topology: Topology::TriangleList,
            cull: None,
            front_ccw: true,
            color: Vec::new(),
            depth: None,
            samples: 1,
            region: None,
            extent: [16, 16],
        }
    }

    fn whole(&self, object: ObjectId) -> View {
        view(self, object, None, None)
    }
}

pub fn texture(format: TextureFormat, width: u32, height: u32) -> Texture {
    let usages = TextureUsages::TEXTURE_BINDING
        | if meniscus::format::is_renderable(format, wgpu_types::Features::empty()) {
            TextureUsages::RENDER_ATTACHMENT
        } else {
            TextureUsages::empty()
        };
    Texture { format, width, height, layers: 1, is_3d: false, mips: 1, samples: 1, usages }
}

fn bindings(plan: &Plan, module: usize, bound: &[(&str, Bound)], stages: ShaderStages) -> Vec<Binding> {
    bound
        .iter()
        .map(|(name, bound)| {
            let (_, global) = plan.modules[module].global(name).unwrap_or_else(|| panic!("no global `{name}`"));
            let mut bound = bound.clone();
            // As the shader has it.
            match (&mut bound, &global.kind) {
                (Bound::Texture { view, .. }, GlobalKind::Texture { dimension, .. })
                | (Bound::StorageTexture { view, .. }, GlobalKind::StorageTexture { dimension, .. }) => {
                    view.dimension = *dimension;
                }
                _ => {}
            }
            Binding { binding: global.binding, name: (*name).into(), stages, bound }
        })
        .collect()
}

/// A mip, or all; a layer, or all.
pub fn view(plan: &Plan, object: ObjectId, mip: Option<u32>, layer: Option<u32>) -> View {
    let (mips, layers) = match &plan.objects[object].kind {
        ObjectKind::Texture(t) => (t.mips, t.layers),
        ObjectKind::Buffer(_) => (1, 1),
    };
    View {
        object: ObjectRef::Fixed(object),
        mips: mip.map_or(0..mips, |m| m..m + 1),
        layers: layer.map_or(0..layers, |l| l..l + 1),
        dimension: TextureDimension::D2,
    }
}

pub fn storage(object: ObjectId) -> Bound {
    Bound::Storage { buffer: ObjectRef::Fixed(object), writable: true }
}

pub fn read_only(object: ObjectId) -> Bound {
    Bound::Storage { buffer: ObjectRef::Fixed(object), writable: false }
}

pub fn sampled(plan: &Plan, object: ObjectId) -> Bound {
    let ObjectKind::Texture(t) = &plan.objects[object].kind else { panic!("no texture") };
    let multisampled = t.samples > 1;
    Bound::Texture { view: plan.whole(object), sample: sample_kind(t.format), filtered: false, multisampled }
}

pub fn target(plan: &Plan, object: ObjectId, clear: Option<[f64; 4]>) -> ColorTarget {
    let ObjectKind::Texture(t) = &plan.objects[object].kind else { panic!("no texture") };
    ColorTarget {
        view: view(plan, object, Some(0), Some(0)),
        format: t.format,
        clear,
        discard_before: false,
        blend: None,
        write: [true; 4],
        resolve: None,
    }
}

/// Reversed depth: nearest wins and is written.
pub fn depth(plan: &Plan, object: ObjectId, compare: Compare, clear: Option<f32>) -> DepthTarget {
    let ObjectKind::Texture(t) = &plan.objects[object].kind else { panic!("no texture") };
    DepthTarget {
        view: view(plan, object, Some(0), Some(0)),
        format: t.format,
        compare,
        write: true,
        clear,
        bias: (0, 0.0),
        stencil: None,
    }
}

pub fn prepare(engine: &mut Engine, plan: Plan) -> Runner {
    engine.prepare(plan, None).unwrap_or_else(|refused| panic!("{:#?}", refused.diagnostics))
}

pub fn refused(engine: &mut Engine, plan: Plan, previous: Option<Runner>) -> Box<Refused> {
    engine.prepare(plan, previous).expect_err("the plan is wrong")
}

pub fn nothing_live(_: &str, _: Option<&meniscus::engine::StepInfo>) -> Option<Value> {
    None
}

pub fn frame() -> Frame<'static> {
    Frame { time: 0.0, delta: 0.0, frame: 0, steps: &[], live: &nothing_live, only: None }
}

/// Runs one frame to its end.
pub fn run(engine: &mut Engine, runner: &mut Runner) -> Report {
    runner.run(engine, &frame()).unwrap_or_else(|d| panic!("{d:#?}"));
    runner.finish(engine).unwrap_or_else(|d| panic!("{d:#?}"))
}

pub fn words(engine: &Engine, runner: &Runner, object: ObjectId) -> Vec<u32> {
    let bytes = runner.read_buffer(engine, ObjectRef::Fixed(object)).unwrap_or_else(|d| panic!("{d:#?}"));
    bytes.chunks(4).map(|c| u32::from_le_bytes(c.try_into().expect("4 bytes"))).collect()
}

pub fn texels(engine: &mut Engine, runner: &Runner, object: ObjectId, mip: u32, layer: u32) -> Vec<[f32; 4]> {
    runner
        .read_texture(engine, ObjectRef::Fixed(object), mip, Some(layer))
        .unwrap_or_else(|d| panic!("{d:#?}"))
        .to_rgba_f32()
}

pub trait ObjectRefExt {
    /// The red of one texel of layer 0.
    fn first_red(self, engine: &mut Engine, runner: &Runner, at: u32) -> f32;
}

impl ObjectRefExt for ObjectRef {
    fn first_red(self, engine: &mut Engine, runner: &Runner, at: u32) -> f32 {
        let data = runner.read_texture(engine, self, 0, Some(0)).unwrap_or_else(|d| panic!("{d:#?}"));
        data.to_rgba_f32()[at as usize][0]
    }
}
