//! Preparing anew, failing, sharing, reporting.

use meniscus::diagnostic::Code;
use meniscus::engine::{Engine, Gpu, GpuOptions, Policy, is_device_gone};
use meniscus::format::TextureFormat;
use meniscus::graph::model::{Address, Sampler, Sp};
use meniscus::plan::model::*;
use wgpu_types::{Features, TextureUsages};

use crate::support::*;

const FILL: &str = "
var<storage, read_write> out: array<u32>;
override value: u32 = 3u;
@compute @workgroup_size(1) fn main() { out[0] += value; }";

fn counting_plan(value: f64) -> (Plan, ObjectId) {
    let mut plan = new_plan();
    let out = plan.buffer("out", 1);
    let pass = plan.compute("add", FILL, &[("out", storage(out))], Dispatch::Groups([1, 1, 1]));
    if let PassKind::Compute { shader, .. } = &mut plan.passes[pass].kind {
        shader.constants.push(("value".into(), value));
    }
    (plan, out)
}

pub fn pipelines_are_found_again(engine: &mut Engine) {
    let (plan, out) = counting_plan(3.0);
    let runner = prepare(engine, plan.clone());
    let built = runner.build_report();
    assert_eq!((built.pipelines_built, built.pipelines_reused, built.memory_bytes), (1, 0, 4));
    let runner = engine.prepare(plan, Some(runner)).unwrap();
    let built = runner.build_report();
    assert_eq!((built.pipelines_built, built.pipelines_reused), (0, 1));
    // Another constant is another pipeline.
    let (other, _) = counting_plan(4.0);
    let mut runner = engine.prepare(other, Some(runner)).unwrap();
    assert_eq!(runner.build_report().pipelines_built, 1);
    run(engine, &mut runner);
    assert_eq!(words(engine, &runner, out), [4]);
}

pub fn a_failure_leaves_the_runner_before(engine: &mut Engine) {
    let (plan, out) = counting_plan(3.0);
    let mut runner = prepare(engine, plan.clone());
    run(engine, &mut runner);
    // A texture larger than any device has.
    let mut wrong = plan.clone();
    let huge = wrong.texture("huge", TextureFormat::Rgba32Float, 1 << 20, 4);
    // What no pass uses would have no memory.
    wrong.pass("clear", PassKind::Clear { view: wrong.whole(huge), value: [0.0; 4] });
    let back = refused(engine, wrong, Some(runner));
    assert!(back.diagnostics.iter().all(|d| d.id == Code::DEVICE && !is_device_gone(d)), "{:?}", back.diagnostics);
    assert!(back.diagnostics.iter().any(|d| d.message.contains("`huge`")), "{:?}", back.diagnostics);
    // A buffer where the layout wants a texture: the pipeline does not fit its shader.
    let mut wrong = plan.clone();
    if let PassKind::Compute { shader, .. } = &mut wrong.passes[0].kind {
        shader.bindings[0].bound = Bound::Storage { buffer: ObjectRef::Fixed(out), writable: false };
    }
    let back = refused(engine, wrong, back.previous);
    assert!(back.diagnostics.iter().any(|d| d.message.contains("`add`")), "{:?}", back.diagnostics);
    let mut runner = back.previous.expect("what ran before");
    run(engine, &mut runner);
    assert_eq!(words(engine, &runner, out), [6]);
    // What was refused is not in the cache.
    let runner = engine.prepare(plan, Some(runner)).unwrap();
    assert_eq!(words(engine, &runner, out), [6], "equal memory goes over");
}

pub fn a_lacking_feature_is_told_by_name(engine: &mut Engine) {
    let (mut plan, _) = counting_plan(1.0);
    plan.needs.features = Features::EXPERIMENTAL_RAY_QUERY;
    let back = refused(engine, plan, None);
    assert!(back.diagnostics.iter().any(|d| d.id == Code::DEVICE_LIMIT && d.message.contains("ray-query")));
}

pub fn passes_are_timed(engine: &mut Engine) {
    assert!(engine.gpu().features().contains(Features::TIMESTAMP_QUERY), "this device tells no time");
    const BUSY: &str = "
var<storage, read_write> out: array<f32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    var x = f32(id.x);
    for (var i = 0u; i < 2000u; i++) { x = sin(x) + 1.0; }
    out[id.x] = x;
}";
    let mut plan = new_plan();
    let (out, copy) = (plan.buffer("out", 6400), plan.buffer("copy", 6400));
    plan.compute("busy", BUSY, &[("out", storage(out))], Dispatch::Groups([100, 1, 1]));
    plan.pass("copy", PassKind::Copy { from: plan.whole(out), to: plan.whole(copy) });
    let mut runner = prepare(engine, plan);
    for number in 0..10 {
        // More frames than may be on their way at once, without a wait.
        let report = runner.run(engine, &meniscus::engine::Frame { frame: number, ..frame() }).unwrap();
        assert!(!report.complete && report.frame == number);
        assert_eq!(report.passes.len(), 2);
    }
    let report = runner.finish(engine).unwrap();
    assert!(report.complete, "{report:?}");
    assert_eq!(report.frame, 9);
    assert!(report.passes[0].gpu_ms.is_some_and(|ms| ms > 0.0), "{report:?}");
    assert!(report.encode_ms > 0.0);
    assert_eq!(runner.poll(engine), None, "each answer comes once");
}

pub fn a_texture_goes_from_graph_to_graph(engine: &mut Engine) {
    const READ: &str = "
var picture: texture_2d<f32>;
var<storage, read_write> out: array<u32>;
@compute @workgroup_size(1) fn main() { out[0] = u32(textureLoad(picture, vec2(0u), 0).x); }";
    let mut first = new_plan();
    let made = first.texture("made", TextureFormat::R32Float, 4, 4);
    first.pass("clear", PassKind::Clear { view: first.whole(made), value: [42.0; 4] });
    let mut second = new_plan();
    let (picture, out) = (second.texture("picture", TextureFormat::R32Float, 4, 4), second.buffer("out", 1));
    second.objects[picture].origin = Origin::Input("picture".into());
    let bound = [("picture", sampled(&second, picture)), ("out", storage(out))];
    second.compute("read", READ, &bound, Dispatch::Groups([1, 1, 1]));
    let (mut first, mut second) = (prepare(engine, first), prepare(engine, second));
    run(engine, &mut second);
    assert_eq!(words(engine, &second, out), [0], "an input that nobody filled is zero");
    second.share(picture, &first, ObjectRef::Fixed(made)).unwrap();
    run(engine, &mut first);
    run(engine, &mut second);
    assert_eq!(words(engine, &second, out), [42]);
    // Writing to the input does not write to the other graph's texture.
    let seven: Vec<u8> = [7.0f32; 16].iter().flat_map(|f| f.to_le_bytes()).collect();
    second.upload_texture(engine, picture, 0, 0, &seven).unwrap();
    run(engine, &mut second);
    assert_eq!(words(engine, &second, out), [7]);
    assert_eq!(texels(engine, &first, made, 0, 0)[0][0], 42.0);
    assert!(second.share(out, &first, ObjectRef::Fixed(made)).is_err(), "a buffer is no texture");
}

pub fn objects_share_memory_as_the_policy_says(engine: &mut Engine) {
    let plan = || {
        let mut plan = new_plan();
        let ids = ["a", "b", "c"].map(|n| plan.texture(n, TextureFormat::Rgba8Unorm, 64, 64));
        for (id, value) in ids.into_iter().zip([0.0, 1.0, 0.0]) {
            plan.pass(&format!("clear{id}"), PassKind::Clear { view: plan.whole(id), value: [value; 4] });
        }
        plan.memory.share = vec![Slot { objects: vec![ids[0], ids[2]], bytes: 64 * 64 * 4 }];
        (plan, ids)
    };
    let (keep, ids) = plan();
    let mut runner = prepare(engine, keep);
    assert_eq!(runner.memory_bytes(), 3 * 64 * 64 * 4);
    run(engine, &mut runner);
    assert_eq!(texels(engine, &runner, ids[1], 0, 0)[0][0], 1.0);
    let (mut smallest, ids) = plan();
    smallest.memory.policy = Policy::Share;
    let runner = engine.prepare(smallest, Some(runner)).unwrap();
    assert_eq!(runner.memory_bytes(), 2 * 64 * 64 * 4);
    assert_eq!(runner.texture(ObjectRef::Fixed(ids[0])).unwrap(), runner.texture(ObjectRef::Fixed(ids[2])).unwrap());
}

pub fn samplers_filter_or_not(engine: &mut Engine) {
    const READ: &str = "
var picture: texture_2d<f32>;
var soft: sampler;
var hard: sampler;
var<storage, read_write> out: array<f32>;
@compute @workgroup_size(1) fn main() {
    out[0] = textureSampleLevel(picture, soft, vec2(0.5), 0.0).x;
    out[1] = textureSampleLevel(picture, hard, vec2(0.25, 0.5), 0.0).x;
}";
    let mut plan = new_plan();
    let about = Texture { usages: TextureUsages::TEXTURE_BINDING, ..texture(TextureFormat::Rgba16Float, 2, 1) };
    let (picture, out) = (plan.texture_as("picture", about), plan.buffer("out", 2));
    plan.objects[picture].origin = Origin::Input("picture".into());
    for (name, linear) in [("soft", true), ("hard", false)] {
        let name = Sp { value: name.into(), span: SPAN };
        plan.samplers.push(Sampler {
            name,
            linear,
            mip_linear: false,
            address: Address::Clamp,
            compare: None,
            anisotropy: 1,
        });
    }
    let picture_bound = Bound::Texture {
        view: plan.whole(picture),
        sample: meniscus::format::SampleKind::Float,
        filtered: true,
        multisampled: false,
    };
    let bound = [
        ("picture", picture_bound),
        ("soft", Bound::Sampler { sampler: 0 }),
        ("hard", Bound::Sampler { sampler: 1 }),
        ("out", storage(out)),
    ];
    plan.compute("read", READ, &bound, Dispatch::Groups([1, 1, 1]));
    let mut runner = prepare(engine, plan);
    // 2 and 4 as halves, in red.
    let texels: [u16; 8] = [0x4000, 0, 0, 0, 0x4400, 0, 0, 0];
    let bytes: Vec<u8> = texels.iter().flat_map(|h| h.to_le_bytes()).collect();
    runner.upload_texture(engine, picture, 0, 0, &bytes).unwrap();
    run(engine, &mut runner);
    let out: Vec<f32> = words(engine, &runner, out).into_iter().map(f32::from_bits).collect();
    assert_eq!(out, [3.0, 2.0]);
}

pub fn a_lost_device_is_told_as_such(engine: &mut Engine) {
    let (plan, _) = counting_plan(1.0);
    let mut runner = prepare(engine, plan);
    engine.gpu().device().destroy();
    engine.gpu().poll();
    let failed = runner.run(engine, &frame()).unwrap_err();
    assert!(failed.iter().any(is_device_gone), "{failed:?}");
}

pub fn an_unknown_backend_is_told(_: &mut Engine) {
    let options = GpuOptions { backend: Some("vulcan".into()), ..GpuOptions::default() };
    let diagnostic = Gpu::open(&options).map(|_| ()).unwrap_err();
    assert!(diagnostic.hints.iter().any(|h| h.contains("`vulkan`")), "{diagnostic:?}");
    let adapters = Gpu::adapters(&GpuOptions::default()).unwrap();
    assert!(!adapters.is_empty());
}

pub fn poison_shows_holes(engine: &mut Engine) {
    const HALF: &str = "
var<storage, read_write> out: array<f32>;
@compute @workgroup_size(1) fn main() { out[0] = 1.0; }";
    let mut plan = new_plan();
    let (out, picture) = (plan.buffer("out", 2), plan.texture("picture", TextureFormat::Rgba16Float, 3, 2));
    plan.compute("half", HALF, &[("out", storage(out))], Dispatch::Groups([1, 1, 1]));
    let mut runner = prepare(engine, plan);
    runner.poison(engine).unwrap();
    run(engine, &mut runner);
    let [whole, hole] = words(engine, &runner, out)[..] else { panic!("two items") };
    assert_eq!(f32::from_bits(whole), 1.0);
    assert!(f32::from_bits(hole).is_nan());
    assert!(texels(engine, &runner, picture, 0, 0).iter().flatten().all(|v| v.is_nan()));
}

/// What an embedder opened, here without any driver: all is validated and nothing runs.
pub fn a_device_may_come_from_outside(_: &mut Engine) {
    let descriptor = wgpu::DeviceDescriptor { required_limits: wgpu::Limits::default(), ..Default::default() };
    let (device, queue) = wgpu::Device::noop(&descriptor);
    let mut engine = Engine::new(Gpu::from_parts(None, device, queue));
    let (plan, _) = counting_plan(1.0);
    let mut runner = prepare(&mut engine, plan.clone());
    let report = run(&mut engine, &mut runner);
    assert!(report.complete && report.passes[0].gpu_ms.is_none(), "{report:?}");
    let mut wrong = plan;
    if let PassKind::Compute { dispatch, .. } = &mut wrong.passes[0].kind {
        *dispatch = Dispatch::Groups([100_000, 1, 1]);
    }
    let mut runner = prepare(&mut engine, wrong);
    let failed = runner.run(&engine, &frame()).unwrap_err();
    assert!(failed.iter().any(|d| d.message.contains("add")), "the pass is named: {failed:?}");
}
