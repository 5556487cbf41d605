//! What is drawn on both sides.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::mpsc;

use glam::DVec3;
use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::{Engine, Gpu, Runner};
use meniscus::files::{DiskFiles, Files, MemoryFiles};
use meniscus::graph::value::Value;
use meniscus::plan::instantiate;
use meniscus::plan::model::{InputInfo, Origin, Plan, Request};
use meniscus::program::{self, Program};
use meniscus::scene::{Camera, Light};

/// Metres.
const RADIUS: f32 = 0.03;

pub struct Case {
    pub name: String,
    pub frames: usize,
    /// Three floats to a particle.
    pub positions: Vec<u8>,
    program: Program,
    viewport: [u32; 2],
}

/// 200 small dispatches, each reading what the one before wrote.
pub fn chain() -> Case {
    const GRAPH: &str = r#"Graph(
        params: { "gain": Float(default: 0.75, min: 0.0, max: 9.0) },
        resources: { "a": Buffer(items: 4096), "b": Like("a") },
        passes: [
            Compute(name: "first", shader: "first.wgsl", each: Item("a"), bind: {"dst": "a"}),
            Repeat(times: 199, swap: [("a", "b")], passes: [
                Compute(name: "next", shader: "next.wgsl", each: Item("b"), bind: {"src": "a", "dst": "b"}),
            ]),
        ],
        outputs: ["a"],
    )"#;
    const FIRST: &str = "var<storage, read_write> dst: array<f32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) { dst[i.x] = f32(i.x); }";
    const NEXT: &str = "struct Values { gain: f32, time: f32 } var<uniform> values: Values;
        var<storage, read> src: array<f32>; var<storage, read_write> dst: array<f32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>) {
            dst[i.x] = src[i.x ^ 1u] * values.gain + values.time; }";
    let files = MemoryFiles::default()
        .with("graphs/chain.ron", GRAPH)
        .with("shaders/first.wgsl", FIRST)
        .with("shaders/next.wgsl", NEXT);
    let program = load(&files, "graphs/chain.ron");
    Case {
        name: "a chain of 200 small compute passes".into(),
        frames: 300,
        positions: Vec::new(),
        program,
        viewport: [64, 64],
    }
}

/// A shipped graph over a ball of particles.
pub fn shipped(graph: &str, viewport: [u32; 2]) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("graphs").join(graph);
    let steps = -9..=9;
    let grid = steps.clone().flat_map(|x| steps.clone().map(move |y| (x, y)));
    let all = grid.flat_map(|(x, y)| (-9..=9).map(move |z| [x, y, z].map(|n| n as f32 * 2.0 * RADIUS)));
    let ball = all.filter(|p| p.iter().map(|x| x * x).sum::<f32>() < 0.45 * 0.45);
    let far = [0.9, 0.6, 0.0];
    let positions = ball.chain([far]).flatten().flat_map(f32::to_le_bytes).collect();
    Case {
        name: format!("{graph} at {} x {}", viewport[0], viewport[1]),
        frames: if viewport[0] > 200 { 48 } else { 120 },
        positions,
        program: load(&DiskFiles, path.to_str().unwrap()),
        viewport,
    }
}

fn load(files: &dyn Files, path: &str) -> Program {
    let mut sources = Sources::new();
    let loaded = program::load(files, &mut sources, path, None);
    loaded.program.unwrap_or_else(|| panic!("{}", render_all(&loaded.diagnostics, &sources, Style::Plain)))
}

impl Case {
    pub fn plan(&self, engine: &Engine) -> Plan {
        let particles = InputInfo::Particles {
            count: self.positions.len() as u64 / 12,
            radius: f64::from(RADIUS),
            min: [-0.5; 3],
            max: [0.9, 0.6, 0.5],
            attributes: vec![("position".into(), 3)],
        };
        let inputs = [("camera", InputInfo::Camera), ("sun", InputInfo::Light), ("particles", particles)];
        let named = self.program.root.inputs.iter().map(|input| input.name.value.clone()).collect::<Vec<_>>();
        let fed = inputs.into_iter().filter(|(name, _)| named.iter().any(|n| n == name));
        let request = Request {
            viewport: self.viewport,
            params: BTreeMap::new(),
            inputs: fed.map(|(name, info)| (name.to_owned(), info)).collect(),
            capacities: BTreeMap::new(),
            roots: Vec::new(),
            stats: false,
            memory: Default::default(),
            features: engine.gpu().features(),
            limits: engine.gpu().limits(),
        };
        instantiate(&self.program, &request).unwrap_or_else(|d| panic!("{d:?}"))
    }

    pub fn upload(&self, engine: &Engine, runner: &mut Runner) {
        for object in 0..runner.plan().objects.len() {
            let origin = &runner.plan().objects[object].origin;
            if matches!(origin, Origin::Attribute { attribute, .. } if attribute == "position") {
                runner.upload_buffer(engine, object, &self.positions).unwrap();
            }
        }
    }
}

pub fn seconds(nth: usize) -> f64 {
    nth as f64 / 64.0
}

pub fn time(nth: usize) -> Value {
    Value::Float(seconds(nth))
}

/// A camera that goes around, and the sun.
pub fn live(nth: usize) -> BTreeMap<String, Value> {
    let angle = nth as f64 * 0.01;
    let camera = Camera::new(DVec3::new(2.5 * angle.cos(), 1.2, 2.5 * angle.sin()), DVec3::ZERO, 45.0);
    let sun = Light { direction: DVec3::new(-0.45, -0.75, -0.5), color: DVec3::ONE, intensity: 4.0 };
    let mut values = BTreeMap::new();
    for (name, _) in meniscus::plan::fields::CAMERA {
        values.extend(camera.field(name, [96, 72]).map(|value| (format!("camera.{name}"), value)));
    }
    for (name, _) in meniscus::plan::fields::LIGHT {
        values.extend(sun.field(name).map(|value| (format!("sun.{name}"), value)));
    }
    values
}

pub fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<u8> {
    fetch(gpu, buffer.size(), |encoder, target| encoder.copy_buffer_to_buffer(buffer, 0, target, 0, buffer.size()))
}

/// Mip 0 of every layer, without padding.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<u8> {
    let texel = texture.format().block_copy_size(None).unwrap();
    let row = (texture.width() * texel).next_multiple_of(256);
    let bytes = u64::from(row) * u64::from(texture.height()) * u64::from(texture.depth_or_array_layers());
    let padded = fetch(gpu, bytes, |encoder, target| {
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(texture.height()) };
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: target, layout },
            texture.size(),
        );
    });
    let tight = padded.chunks_exact(row as usize).flat_map(|line| &line[..(texture.width() * texel) as usize]);
    tight.copied().collect()
}

fn fetch(gpu: &Gpu, bytes: u64, copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer)) -> Vec<u8> {
    let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    copy(&mut encoder, &buffer);
    gpu.queue().submit([encoder.finish()]);
    let (sender, receiver) = mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |mapped| _ = sender.send(mapped));
    gpu.wait().unwrap();
    receiver.recv().unwrap().unwrap();
    buffer.get_mapped_range(..).unwrap().to_vec()
}
