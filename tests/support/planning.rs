//! Plans of small graphs that live in memory.

#![allow(dead_code, reason = "each test program uses a part of it")]

use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::files::MemoryFiles;
use meniscus::format::TextureFormat;
use meniscus::graph::value::Value;
use meniscus::plan::instantiate;
use meniscus::plan::model::{
    Binding, Bound, InputInfo, ObjectId, ObjectRef, PassKind, Plan, Request, ShaderUse, Texture, View,
};
use meniscus::program;
use wgpu_types::{Features, Limits, TextureUsages};

/// Shaders that tests share: `dst` is written, `src` is read.
const SHADERS: &[(&str, &str)] = &[
    // Whole writes.
    ("fill.wgsl", "var<storage, read_write> dst: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) { dst[i.x] = i.x; }"),
    ("copy.wgsl", "var<storage, read> src: array<u32>; var<storage, read_write> dst: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) { dst[i.x] = src[i.x]; }"),
    // Keeps what was there.
    ("add.wgsl", "var<storage, read_write> dst: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) { dst[i.x] += 1u; }"),
    ("image.wgsl", "var dst: texture_storage_2d<rgba16float, write>;
        @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
            textureStore(dst, i.xy, vec4<f32>(1.0)); }"),
    ("paint.wgsl", "@fragment fn main() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }"),
    ("filter.wgsl", "var src: texture_2d<f32>;
        @fragment fn main(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32> {
            return textureLoad(src, vec2<i32>(p.xy), 0); }"),
    ("layers.wgsl", "var src: texture_2d_array<f32>;
        @fragment fn main(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32> {
            return textureLoad(src, vec2<i32>(p.xy), 1, 0); }"),
    ("sample.wgsl", "var src: texture_2d<f32>; var linear_clamp: sampler;
        @fragment fn main(@location(0) uv: vec2<f32>) -> @location(0) vec4<f32> {
            return textureSampleLevel(src, linear_clamp, uv, 1.0); }"),
    // Appending, and threads over what was appended.
    ("append.wgsl", "struct List { count: atomic<u32>, items: array<u32> }
        var<storage, read_write> list: List;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
            let at = atomicAdd(&list.count, 1u); if at < arrayLength(&list.items) { list.items[at] = i.x; } }"),
    ("consume.wgsl", "struct List { count: u32, items: array<u32> }
        var<storage, read> list: List; var<storage, read_write> dst: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
            if i.x < list.count { dst[i.x] = list.items[i.x]; } }"),
    ("points.wgsl", "struct List { count: u32, items: array<u32> }
        var<storage, read> list: List;
        @vertex fn corner(@builtin(instance_index) i: u32) -> @builtin(position) vec4<f32> {
            return vec4<f32>(f32(list.items[i])); }
        @fragment fn main() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }"),
    ("arguments.wgsl", "struct Arguments { vertices: u32, instances: u32, first_vertex: u32, first_instance: u32 }
        var<storage, read_write> dst: array<Arguments>;
        @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
            dst[i.x] = Arguments(3u, 1u, 0u, 0u); }"),
    ("triangle.wgsl", "@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
            return vec4<f32>(f32(i)); }
        @fragment fn main() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }"),
    // Causes.
    ("eye.wgsl", "struct Eye { position: vec3<f32> } var<uniform> camera: Eye;
        var<storage, read_write> dst: array<f32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) { dst[i.x] = camera.position.x; }"),
    ("clock.wgsl", "struct Now { time: f32 } var<uniform> now: Now;
        var<storage, read_write> dst: array<f32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) { dst[i.x] = now.time; }"),
    ("gain.wgsl", "struct Values { gain: f32 } var<uniform> values: Values;
        var<storage, read_write> dst: array<f32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) { dst[i.x] = values.gain; }"),
    ("constant.wgsl", "override n: u32 = 9u; var<storage, read_write> dst: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) { dst[i.x] = n; }"),
    ("mix.wgsl", "var<storage, read> left: array<f32>; var<storage, read> right: array<f32>;
        var<storage, read_write> dst: array<f32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
            dst[i.x] = left[i.x] + right[i.x]; }"),
    // A step: what was, and what is.
    ("step.wgsl", "struct Now { step: u32 } var<uniform> now: Now;
        var<storage, read> src: array<u32>; var<storage, read_write> dst: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
            dst[i.x] = src[i.x] + now.step; }"),
    ("atomic.wgsl", "var<storage, read_write> total: atomic<u32>; var<storage, read_write> dst: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
            dst[i.x] = atomicAdd(&total, 1u); }"),
];

/// A planner with its files and what it is asked for.
pub struct Test {
    files: MemoryFiles,
    pub request: Request,
}

impl Test {
    /// With `graphs/test.ron` in place.
    pub fn new(graph: &str) -> Self {
        let mut files = MemoryFiles::default().with("graphs/test.ron", graph);
        for (name, text) in SHADERS {
            files = files.with(format!("shaders/{name}"), text);
        }
        let request = Request {
            viewport: [64, 48],
            params: Default::default(),
            inputs: Default::default(),
            capacities: Default::default(),
            roots: Vec::new(),
            stats: false,
            memory: Default::default(),
            features: Features::all(),
            limits: Limits::default(),
        };
        Self { files, request }
    }

    /// A graph of these resources, passes and outputs, and nothing else.
    pub fn of(resources: &str, passes: &str, outputs: &str) -> Self {
        Self::new(&format!("Graph(resources: {{ {resources} }}, passes: [ {passes} ], outputs: [ {outputs} ])"))
    }

    pub fn with(mut self, path: &str, text: &str) -> Self {
        self.files = self.files.with(path, text);
        self
    }

    pub fn param(mut self, path: &str, value: Value) -> Self {
        self.request.params.insert(path.into(), value);
        self
    }

    pub fn input(mut self, name: &str, info: InputInfo) -> Self {
        self.request.inputs.insert(name.into(), info);
        self
    }

    pub fn root(mut self, path: &str) -> Self {
        self.request.roots.push(path.into());
        self
    }

    pub fn try_plan(&self) -> Result<Plan, (Diagnostics, Sources)> {
        self.with_sources().0.map_err(|(found, sources)| (found, *sources))
    }

    /// What came of planning, and the texts that spans point into.
    pub fn with_sources(&self) -> (Result<Plan, (Diagnostics, Box<Sources>)>, Sources) {
        let mut sources = Sources::new();
        let planned = self.plan_into(&mut sources).map_err(|found| (found, Box::new(sources.clone())));
        (planned, sources)
    }

    fn plan_into(&self, sources: &mut Sources) -> Result<Plan, Diagnostics> {
        let loaded = program::load(&self.files, sources, "graphs/test.ron", None);
        let Some(program) = loaded.program else { return Err(loaded.diagnostics) };
        instantiate(&program, &self.request)
    }

    pub fn plan(&self) -> Plan {
        self.try_plan().unwrap_or_else(|(found, sources)| {
            panic!("{}", render_all(&found, &sources, Style::Plain));
        })
    }
}

/// Paths of the live passes.
pub fn paths(plan: &Plan) -> Vec<&str> {
    plan.passes.iter().map(|p| p.path.as_str()).collect()
}

/// Paths of the passes that were left out.
pub fn culled(plan: &Plan) -> Vec<&str> {
    plan.culled.iter().map(|c| c.path.as_str()).collect()
}

pub fn pass(plan: &Plan, path: &str) -> usize {
    plan.passes.iter().position(|p| p.path == path).unwrap_or_else(|| panic!("no pass {path} in {:?}", paths(plan)))
}

pub fn object(plan: &Plan, path: &str) -> ObjectId {
    let found = plan.objects.iter().position(|o| o.path == path);
    found.unwrap_or_else(|| panic!("no {path} in {:?}", plan.objects.iter().map(|o| &o.path).collect::<Vec<_>>()))
}

/// The shader of a pass.
pub fn shader(plan: &Plan, at: usize) -> &ShaderUse {
    match &plan.passes[at].kind {
        PassKind::Compute { shader, .. } => shader,
        PassKind::Draw(draw) => &draw.shader,
        other => panic!("no shader in {other:?}"),
    }
}

/// What a variable of a pass's shader is bound to.
pub fn bound(plan: &Plan, at: usize, name: &str) -> ObjectRef {
    let binding: &Binding = shader(plan, at).bindings.iter().find(|b| *b.name == *name).unwrap();
    match &binding.bound {
        Bound::UniformBuffer { buffer } | Bound::Storage { buffer, .. } => *buffer,
        Bound::Texture { view: View { object, .. }, .. } | Bound::StorageTexture { view: View { object, .. }, .. } => {
            *object
        }
        other => panic!("{name} is {other:?}"),
    }
}

/// The path of what a variable of a pass's shader is bound to.
pub fn bound_path<'a>(plan: &'a Plan, at: usize, name: &str) -> &'a str {
    &plan.objects[objects(plan, bound(plan, at, name))[0]].path
}

/// Every object that a reference may stand for.
pub fn objects(plan: &Plan, object: ObjectRef) -> Vec<ObjectId> {
    match object {
        ObjectRef::Fixed(id) => vec![id],
        ObjectRef::Ring { ring, .. } => plan.rings[ring].objects.clone(),
    }
}

/// A flat picture of eight by eight texels.
pub fn texture(format: TextureFormat) -> Texture {
    Texture {
        format,
        width: 8,
        height: 8,
        layers: 1,
        is_3d: false,
        mips: 1,
        samples: 1,
        usages: TextureUsages::empty(),
    }
}
