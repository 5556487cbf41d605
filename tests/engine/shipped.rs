//! The shipped graphs, from their files to a picture: planned with the device's own limits, no
//! error of wgpu's may come up anywhere.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{Mat4, Vec3, Vec4};
use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::{Engine, Frame, Runner, StepInfo};
use meniscus::files::DiskFiles;
use meniscus::graph::value::Value;
use meniscus::plan::instantiate;
use meniscus::plan::model::{InputInfo, Origin, Plan, Request};
use meniscus::program;

use crate::support::{self, ObjectRefExt as _};

const VIEWPORT: [u32; 2] = [160, 120];
const RADIUS: f32 = 0.02;
const EYE: Vec3 = Vec3::new(2.0, 1.0, 2.0);

/// A ball of particles on a grid, and one far from it.
fn particles() -> Vec<Vec3> {
    let steps = -12..=12;
    let grid = steps.clone().flat_map(|x| steps.clone().map(move |y| (x, y)));
    let all = grid.flat_map(|(x, y)| (-12..=12).map(move |z| Vec3::new(x as f32, y as f32, z as f32)));
    let mut ball: Vec<Vec3> = all.map(|p| p * 2.0 * RADIUS).filter(|p| p.length() < 0.45).collect();
    ball.push(Vec3::new(0.9, 0.6, 0.0));
    ball
}

fn request(engine: &Engine, particles: &[Vec3]) -> Request {
    let (mut min, mut max) = (Vec3::MAX, Vec3::MIN);
    for p in particles {
        (min, max) = (min.min(*p), max.max(*p));
    }
    let info = InputInfo::Particles {
        count: particles.len() as u64,
        radius: f64::from(RADIUS),
        min: min.to_array().map(f64::from),
        max: max.to_array().map(f64::from),
        attributes: vec![("position".into(), 3)],
    };
    Request {
        viewport: VIEWPORT,
        params: BTreeMap::new(),
        inputs: BTreeMap::from([
            ("camera".into(), InputInfo::Camera),
            ("sun".into(), InputInfo::Light),
            ("particles".into(), info),
        ]),
        capacities: BTreeMap::new(),
        roots: Vec::new(),
        stats: false,
        memory: Default::default(),
        features: engine.gpu().features(),
        limits: engine.gpu().limits(),
    }
}

fn plan(engine: &Engine, graph: &str, particles: &[Vec3]) -> Plan {
    let mut sources = Sources::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("graphs").join(graph);
    let loaded = program::load(&DiskFiles, &mut sources, path.to_str().expect("a path in words"), None);
    let program =
        loaded.program.unwrap_or_else(|| panic!("{}", render_all(&loaded.diagnostics, &sources, Style::Plain)));
    instantiate(&program, &request(engine, particles))
        .unwrap_or_else(|d| panic!("{}", render_all(&d, &sources, Style::Plain)))
}

/// Looks from the eye at the middle.
fn live(name: &str, _: Option<&StepInfo>) -> Option<Value> {
    let eye = EYE;
    let (aspect, near) = (VIEWPORT[0] as f32 / VIEWPORT[1] as f32, 0.05);
    let tan = 0.4;
    let clip_from_view = Mat4::from_cols(
        Vec4::new(1.0 / (tan * aspect), 0.0, 0.0, 0.0),
        Vec4::new(0.0, 1.0 / tan, 0.0, 0.0),
        Vec4::new(0.0, 0.0, 0.0, -1.0),
        Vec4::new(0.0, 0.0, near, 0.0),
    );
    let back = eye.normalize();
    let right = Vec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let view_from_world =
        Mat4::from_cols(right.extend(0.0), up.extend(0.0), back.extend(0.0), eye.extend(1.0)).inverse();
    let matrix = |m: Mat4| Value::vec(m.to_cols_array().map(f64::from));
    let vector = |v: Vec3| Value::vec(v.to_array().map(f64::from));
    let clip_from_world = clip_from_view * view_from_world;
    Some(match name {
        "camera.clip_from_world" => matrix(clip_from_world),
        "camera.world_from_clip" => matrix(clip_from_world.inverse()),
        "camera.view_from_world" => matrix(view_from_world),
        "camera.world_from_view" => matrix(view_from_world.inverse()),
        "camera.clip_from_view" => matrix(clip_from_view),
        "camera.view_from_clip" => matrix(clip_from_view.inverse()),
        "camera.position" => vector(eye),
        "camera.near" => Value::Float(f64::from(near)),
        "camera.far" => Value::Float(1000.0),
        "camera.tan_half_fov" => Value::vec([f64::from(tan * aspect), f64::from(tan)]),
        "camera.viewport" => Value::vec(VIEWPORT.map(f64::from)),
        "camera.pixel_m" => Value::Float(f64::from(2.0 * tan) / f64::from(VIEWPORT[1])),
        "camera.orthographic" => Value::Int(0),
        "sun.direction" => vector(Vec3::new(-0.45, -0.75, -0.5).normalize()),
        "sun.color" => Value::vec([1.0, 0.95, 0.86]),
        "sun.intensity" => Value::Float(4.0),
        _ => return None,
    })
}

fn upload(engine: &Engine, runner: &mut Runner, particles: &[Vec3]) {
    for object in 0..runner.plan().objects.len() {
        if matches!(&runner.plan().objects[object].origin, Origin::Attribute { attribute, .. } if attribute == "position")
        {
            let bytes: Vec<u8> = particles.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
            runner.upload_buffer(engine, object, &bytes).expect("positions fit");
        }
    }
}

fn picture_of(engine: &mut Engine, graph: &str) {
    let particles = particles();
    let plan = plan(engine, graph, &particles);
    let mut runner = support::prepare(engine, plan);
    upload(engine, &mut runner, &particles);
    let mut pictures = Vec::new();
    for poisoned in [false, true] {
        if poisoned {
            runner.poison(engine).expect("memory can be filled");
            // Draws that may then share a render pass.
            runner.time_passes(false);
        }
        let now = Frame { live: &live, ..support::frame() };
        runner.run(engine, &now).unwrap_or_else(|d| panic!("{d:#?}"));
        let report = runner.finish(engine).unwrap_or_else(|d| panic!("{d:#?}"));
        assert_eq!(report.overflows().count(), 0, "{:?}", report.counts);
        assert!(report.passes.iter().all(|p| p.gpu_ms.is_some() != poisoned), "{report:?}");
        let color = runner.plan().outputs[0].object;
        pictures.push(runner.read_texture(engine, color, 0, Some(0)).expect("the picture"));
    }
    let texels = pictures[0].to_rgba_f32();
    let middle = texels[(VIEWPORT[1] / 2 * VIEWPORT[0] + VIEWPORT[0] / 2) as usize];
    assert!(texels.iter().flatten().all(|v| v.is_finite()));
    assert_eq!(middle[3], 1.0, "something is in the middle");
    if runner.plan().passes.iter().all(|p| !p.unordered) {
        assert!(pictures[0] == pictures[1], "no shader leaves holes, and the same frame is the same picture");
    }
    let z = ["body.z", "z", "all.z", "front.z"].iter().find_map(|n| runner.plan().names.get(*n).copied());
    if let Some(z) = z {
        let z = z.first_red(engine, &runner, VIEWPORT[1] / 2 * VIEWPORT[0] + VIEWPORT[0] / 2);
        // The foremost particle on the way from the eye to the middle, give or take what a surface smooths away.
        let back = EYE.normalize();
        let near = particles.iter().filter(|p| p.distance(back * p.dot(back)) < 2.0 * RADIUS);
        let expected = EYE.length() - near.map(|p| p.dot(back)).fold(0.0, f32::max);
        assert!((z.abs() - expected).abs() < 3.0 * RADIUS, "{z} for {expected}");
    }
}

pub fn imai2016(engine: &mut Engine) {
    picture_of(engine, "imai2016.ron");
}

pub fn iwasaki2006(engine: &mut Engine) {
    picture_of(engine, "iwasaki2006.ron");
}

pub fn imai2014(engine: &mut Engine) {
    picture_of(engine, "imai2014.ron");
}
