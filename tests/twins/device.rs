//! Runs a graph file on the device and reads its results back.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{Mat4, Vec4};
use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::{Engine, Frame, Report, Runner, StepInfo};
use meniscus::files::DiskFiles;
use meniscus::graph::value::Value;
use meniscus::plan::instantiate;
use meniscus::plan::model::{InputInfo, Origin, Request};
use meniscus::program;

/// A camera at `eye` that looks along -z.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pub size: [u32; 2],
    pub eye_z: f32,
    /// Tangent of half the vertical angle.
    pub tan: f32,
}

impl View {
    /// The unit direction through a pixel's centre, in eye space.
    pub fn direction(&self, x: u32, y: u32) -> [f64; 3] {
        let [w, h] = self.size.map(f64::from);
        let tan = f64::from(self.tan);
        let across = ((f64::from(x) + 0.5) / w * 2.0 - 1.0) * tan * w / h;
        let up = (1.0 - (f64::from(y) + 0.5) / h * 2.0) * tan;
        crate::ball::unit([across, up, -1.0])
    }

    fn value(&self, name: &str, world_from_view: Mat4) -> Option<Value> {
        let aspect = self.size[0] as f32 / self.size[1] as f32;
        let clip_from_view = Mat4::from_cols(
            Vec4::new(1.0 / (self.tan * aspect), 0.0, 0.0, 0.0),
            Vec4::new(0.0, 1.0 / self.tan, 0.0, 0.0),
            Vec4::new(0.0, 0.0, 0.0, -1.0),
            Vec4::new(0.0, 0.0, 0.01, 0.0),
        );
        let matrix = |m: Mat4| Value::vec(m.to_cols_array().map(f64::from));
        Some(match name {
            "camera.clip_from_world" => matrix(clip_from_view * world_from_view.inverse()),
            "camera.view_from_world" => matrix(world_from_view.inverse()),
            "camera.world_from_view" => matrix(world_from_view),
            "camera.clip_from_view" => matrix(clip_from_view),
            "camera.position" => Value::vec(world_from_view.w_axis.truncate().to_array().map(f64::from)),
            "camera.near" => Value::Float(0.01),
            "camera.viewport" => Value::vec(self.size.map(f64::from)),
            "camera.orthographic" => Value::Int(0),
            _ => return None,
        })
    }
}

/// What a graph is run with.
#[derive(Clone, Debug)]
pub struct Given<'a> {
    /// Below the repository's root.
    pub graph: &'a str,
    pub positions: &'a [[f32; 3]],
    pub radius: f64,
    pub view: View,
    pub params: &'a [(&'a str, Value)],
    /// Instance paths that are read back: what nobody asks for is not run.
    pub read: &'a [&'a str],
}

/// A graph after its frame.
#[derive(Debug)]
pub struct Done<'a> {
    engine: &'a mut Engine,
    runner: Runner,
}

/// Lowest and highest coordinates; zeros where there is nothing.
pub fn bounds(positions: &[[f32; 3]]) -> ([f32; 3], [f32; 3]) {
    let over = |f: fn(f32, f32) -> f32, k: usize| positions.iter().map(|p| p[k]).reduce(f).unwrap_or(0.0);
    ([0, 1, 2].map(|k| over(f32::min, k)), [0, 1, 2].map(|k| over(f32::max, k)))
}

/// Irradiance of the light that [`run_lit`] gives, on what faces it.
pub const SUN: [f64; 3] = [4.0, 3.6, 3.2];

pub fn run<'a>(engine: &'a mut Engine, given: &Given<'_>) -> Done<'a> {
    run_lit(engine, given, [0.0, -1.0, 0.0])
}

/// Where a view's eye is unless somebody says otherwise: on the z axis.
fn on_axis(view: &View) -> Mat4 {
    Mat4::from_translation(glam::Vec3::new(0.0, 0.0, view.eye_z))
}

/// Runs with the light `sun` going in a unit direction.
pub fn run_lit<'a>(engine: &'a mut Engine, given: &Given<'_>, sun: [f64; 3]) -> Done<'a> {
    let mut done = prepare(engine, given);
    done.draw(given.view, on_axis(&given.view), sun);
    done
}

/// A graph before its first frame.
pub fn prepare<'a>(engine: &'a mut Engine, given: &Given<'_>) -> Done<'a> {
    let mut sources = Sources::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(given.graph);
    let loaded = program::load(&DiskFiles, &mut sources, path.to_str().expect("a path in words"), None);
    let program =
        loaded.program.unwrap_or_else(|| panic!("{}", render_all(&loaded.diagnostics, &sources, Style::Plain)));
    let (min, max) = bounds(given.positions);
    let particles = InputInfo::Particles {
        count: given.positions.len() as u64,
        radius: given.radius,
        min: min.map(f64::from),
        max: max.map(f64::from),
        attributes: vec![("position".into(), 3)],
    };
    let all = BTreeMap::from([
        ("camera".to_owned(), InputInfo::Camera),
        ("particles".to_owned(), particles),
        ("sun".to_owned(), InputInfo::Light),
    ]);
    let asked = |name: &String| program.root.inputs.iter().any(|i| i.name.value == *name);
    let request = Request {
        viewport: given.view.size,
        params: given.params.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect(),
        inputs: all.into_iter().filter(|(name, _)| asked(name)).collect(),
        capacities: BTreeMap::new(),
        roots: given.read.iter().map(|name| (*name).to_owned()).collect(),
        stats: false,
        memory: Default::default(),
        features: engine.gpu().features(),
        limits: engine.gpu().limits(),
    };
    let plan = instantiate(&program, &request).unwrap_or_else(|d| panic!("{}", render_all(&d, &sources, Style::Plain)));
    let mut runner = engine.prepare(plan, None).unwrap_or_else(|refused| panic!("{:#?}", refused.diagnostics));
    let bytes: Vec<u8> = given.positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    for object in 0..runner.plan().objects.len() {
        let is_position = matches!(&runner.plan().objects[object].origin,
            Origin::Attribute { attribute, .. } if attribute == "position");
        if is_position && !bytes.is_empty() {
            runner.upload_buffer(engine, object, &bytes).unwrap_or_else(|d| panic!("{d:#?}"));
        }
    }
    Done { engine, runner }
}

impl Done<'_> {
    /// Runs a frame seen from anywhere; the eye looks along its own -z.
    pub fn draw(&mut self, view: View, world_from_view: Mat4, sun: [f64; 3]) -> Report {
        let live = |name: &str, _: Option<&StepInfo>| match name {
            "sun.direction" => Some(Value::vec(sun)),
            "sun.color" => Some(Value::vec(SUN.map(|x| x / 4.0))),
            "sun.intensity" => Some(Value::Float(4.0)),
            _ => view.value(name, world_from_view),
        };
        let frame = Frame { time: 0.0, delta: 0.0, frame: 0, steps: &[], live: &live, only: None };
        self.runner.run(self.engine, &frame).unwrap_or_else(|d| panic!("{d:#?}"));
        self.runner.finish(self.engine).unwrap_or_else(|d| panic!("{d:#?}"))
    }

    /// Has all passes run in each frame, and timed.
    #[allow(dead_code, reason = "a bench asks for it")]
    pub fn time_all(&mut self) {
        self.runner.run_all(true);
        self.runner.time_passes(true);
    }

    /// A buffer's 32-bit words.
    pub fn words(&self, name: &str) -> Vec<u32> {
        let object = self.runner.plan().names[name];
        let bytes = self.runner.read_buffer(self.engine, object).unwrap_or_else(|d| panic!("{d:#?}"));
        bytes.chunks_exact(4).map(|c| u32::from_le_bytes(c.try_into().expect("4 bytes"))).collect()
    }

    pub fn floats(&self, name: &str) -> Vec<f32> {
        self.words(name).into_iter().map(f32::from_bits).collect()
    }

    /// One layer of a texture.
    pub fn texels(&mut self, name: &str, layer: u32) -> Vec<[f32; 4]> {
        let object = self.runner.plan().names[name];
        let data = self.runner.read_texture(self.engine, object, 0, Some(layer));
        data.unwrap_or_else(|d| panic!("{d:#?}")).to_rgba_f32()
    }
}
