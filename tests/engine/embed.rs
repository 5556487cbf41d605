//! A graph among somebody else's commands, textures and buffers.

use meniscus::engine::{Engine, Gpu, Runner};
use meniscus::format::TextureFormat;
use meniscus::plan::model::*;
use wgpu_types::TextureUsages;

use crate::support::*;

const ADD: &str = "
var<storage, read_write> out: array<u32>;
@compute @workgroup_size(1) fn main() { out[0] += 1u; }";
const READ: &str = "
var picture: texture_2d<f32>;
var<storage, read_write> out: array<u32>;
@compute @workgroup_size(1) fn main() { out[0] = u32(textureLoad(picture, vec2(0u), 0).x); }";

fn adding() -> (Plan, ObjectId) {
    let mut plan = new_plan();
    let out = plan.buffer("out", 1);
    plan.compute("add", ADD, &[("out", storage(out))], Dispatch::Groups([1, 1, 1]));
    (plan, out)
}

/// The red of an input's first texel.
fn reading() -> (Plan, ObjectId, ObjectId) {
    let mut plan = new_plan();
    let (picture, out) = (plan.texture("picture", TextureFormat::R32Float, 4, 4), plan.buffer("out", 1));
    plan.objects[picture].origin = Origin::Input("picture".into());
    if let ObjectKind::Texture(texture) = &mut plan.objects[picture].kind {
        texture.usages = TextureUsages::TEXTURE_BINDING;
    }
    let bound = [("picture", sampled(&plan, picture)), ("out", storage(out))];
    plan.compute("read", READ, &bound, Dispatch::Groups([1, 1, 1]));
    (plan, picture, out)
}

/// Clears an input, which the embedder then has.
fn writing() -> (Plan, ObjectId) {
    let mut plan = new_plan();
    plan.graph = "writer.ron".into();
    let picture = plan.texture("picture", TextureFormat::R32Float, 4, 4);
    plan.objects[picture].origin = Origin::Input("picture".into());
    let pass = plan.pass("clear", PassKind::Clear { view: plan.whole(picture), value: [5.0; 4] });
    plan.passes[pass].accesses.push(Access {
        object: ObjectRef::Fixed(picture),
        mips: 0..1,
        layers: 0..1,
        read: false,
        write: true,
        whole: true,
    });
    (plan, picture)
}

fn texture(engine: &Engine, usage: TextureUsages) -> wgpu::Texture {
    engine.gpu().device().create_texture(&wgpu::TextureDescriptor {
        label: Some("theirs"),
        size: wgpu::Extent3d { width: 4, height: 4, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::R32Float,
        usage,
        view_formats: &[],
    })
}

/// A texture of theirs with one value everywhere.
fn filled(engine: &Engine, value: f32) -> wgpu::Texture {
    let texture = texture(engine, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    let bytes: Vec<u8> = [value; 16].into_iter().flat_map(f32::to_le_bytes).collect();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16), rows_per_image: None };
    engine.gpu().queue().write_texture(texture.as_image_copy(), &bytes, layout, texture.size());
    texture
}

fn encoder(engine: &Engine) -> wgpu::CommandEncoder {
    engine.gpu().device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
}

fn submit(engine: &Engine, encoder: wgpu::CommandEncoder) {
    engine.gpu().queue().submit([encoder.finish()]);
}

pub fn frames_go_into_their_commands(engine: &mut Engine) {
    let (plan, out) = adding();
    let mut runner = prepare(engine, plan);
    runner.run_all(true);
    for number in 1..=4 {
        let mut theirs = encoder(engine);
        let frame = meniscus::engine::Frame { frame: number, ..frame() };
        runner.encode(engine, &frame, &mut theirs).unwrap();
        // Their own commands behind ours see what ours did.
        let copy = engine.gpu().device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        theirs.copy_buffer_to_buffer(runner.buffer(ObjectRef::Fixed(out)).unwrap(), 0, &copy, 0, 4);
        submit(engine, theirs);
    }
    engine.gpu().wait().unwrap();
    let report = runner.poll(engine).expect("the answer came with their submission");
    assert!(report.complete && report.frame == 4 || report.frame == 3, "{report:?}");
    assert!(report.passes[0].gpu_ms.is_some());
    assert_eq!((report.submissions, report.compute_passes), (0, 1), "they submit");
    assert_eq!(words(engine, &runner, out), [4]);
}

/// Commands that they throw away take nothing with them but themselves.
pub fn dropped_commands_leave_no_trace(engine: &mut Engine) {
    let (plan, out) = adding();
    let mut runner = prepare(engine, plan);
    runner.run_all(true);
    for _ in 0..8 {
        let mut theirs = encoder(engine);
        runner.encode(engine, &frame(), &mut theirs).unwrap();
    }
    let report = run(engine, &mut runner);
    assert!(report.complete && report.passes[0].gpu_ms.is_some(), "{report:?}");
    assert_eq!(words(engine, &runner, out), [1]);
}

pub fn a_texture_of_theirs_is_checked(engine: &mut Engine) {
    let (plan, picture, out) = reading();
    assert_eq!(plan.needs("picture").map(|(id, _)| id), Some(picture));
    assert!(plan.needs("out").is_none(), "what the frame makes is nobody's to give");
    let mut runner = prepare(engine, plan);
    let unbound = texture(engine, TextureUsages::COPY_DST);
    let refused = runner.share_texture(picture, &unbound).unwrap_err();
    assert!(refused.message.contains("`picture`") && refused.message.contains("TEXTURE_BINDING"), "{refused:?}");
    runner.share_texture_version(picture, &filled(engine, 3.0), 1).unwrap();
    run(engine, &mut runner);
    assert_eq!(words(engine, &runner, out), [3]);
}

pub fn what_is_not_in_the_plan_is_told(engine: &mut Engine) {
    let (plan, picture, out) = reading();
    let mut runner = prepare(engine, plan);
    let theirs = filled(engine, 3.0);
    let refused = [
        runner.share_texture(99, &theirs).unwrap_err(),
        runner.upload_buffer(engine, 99, &[0; 4]).unwrap_err(),
        runner.upload_texture(engine, 99, 0, 0, &[0; 64]).unwrap_err(),
        runner.read_texture(engine, ObjectRef::Fixed(99), 0, None).unwrap_err(),
        runner.read_buffer(engine, ObjectRef::Fixed(99)).unwrap_err(),
    ];
    for refused in refused {
        assert!(refused.message.contains("no object 99") && refused.hints[0].contains("needs"), "{refused:?}");
    }
    runner.mark_changed(99);
    assert!(runner.texture(ObjectRef::Fixed(99)).is_none());
    let ring = ObjectRef::Ring { ring: 9, index: 0 };
    assert!(runner.buffer(ring).is_none());
    let refused = runner.read_buffer(engine, ring).unwrap_err();
    assert!(refused.message.contains("no ring 9"), "{refused:?}");
    let layer = runner.upload_texture(engine, picture, 0, 1, &[0; 64]).unwrap_err();
    assert!(layer.message.contains("no layer 1"), "{layer:?}");
    let mip = runner.upload_texture(engine, picture, u32::MAX, 0, &[0; 64]).unwrap_err();
    assert!(mip.message.contains("no mip 4294967295"), "{mip:?}");
    runner.upload_texture(engine, picture, 0, 0, &[0; 64]).unwrap();
    run(engine, &mut runner);
    assert_eq!(words(engine, &runner, out), [0]);
    let picture = ObjectRef::Fixed(picture);
    for (mip, layer, said) in [(32, None, "no mip 32"), (0, Some(u32::MAX), "no layer 4294967295")] {
        let refused = runner.read_texture(engine, picture, mip, layer).unwrap_err();
        assert!(refused.message.contains(said), "{refused:?}");
    }
    runner.read_texture(engine, picture, 0, Some(0)).unwrap();
}

/// Dropped, a texture lives on while it is in use; destroyed, it is told, and what was drawn last
/// stays until there is another.
pub fn a_texture_that_they_destroy_is_told(engine: &mut Engine) {
    let (plan, picture, out) = reading();
    let mut runner = prepare(engine, plan);
    let first = filled(engine, 3.0);
    runner.share_texture(picture, &first).unwrap();
    drop(first);
    run(engine, &mut runner);
    assert_eq!(words(engine, &runner, out), [3]);
    let second = filled(engine, 4.0);
    runner.share_texture(picture, &second).unwrap();
    second.destroy();
    let told = runner.run(engine, &frame()).unwrap_err();
    assert!(told.iter().any(|d| d.message.contains("theirs")), "{told:?}");
    assert_eq!(words(engine, &runner, out), [3], "what was drawn last");
    runner.share_texture(picture, &filled(engine, 5.0)).unwrap();
    run(engine, &mut runner);
    assert_eq!(words(engine, &runner, out), [5]);
}

pub fn two_graphs_do_not_write_one_texture(engine: &mut Engine) {
    let (plan, picture) = writing();
    let usages = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
    let (shared, other) = (texture(engine, usages), texture(engine, usages));
    let mut one = prepare(engine, plan.clone());
    let mut two = prepare(engine, plan.clone());
    one.share_texture(picture, &shared).unwrap();
    one.share_texture(picture, &shared).expect("it is its own");
    let refused = two.share_texture(picture, &shared).unwrap_err();
    assert!(refused.message.contains("writer.ron"), "{refused:?}");
    assert!(!refused.hints.is_empty());
    two.share_texture(picture, &other).unwrap();
    run(engine, &mut two);
    // One that only reads may have it, and one that follows another takes over.
    let (reader, read, out) = reading();
    let mut reader = prepare(engine, reader);
    reader.share_texture(read, &shared).unwrap();
    run(engine, &mut one);
    run(engine, &mut reader);
    assert_eq!(words(engine, &reader, out), [5]);
    let one = engine.prepare(plan, Some(one)).unwrap();
    drop(two);
    let mut three = prepare(engine, writing().0);
    assert!(three.share_texture(picture, &shared).is_err(), "the one that followed has it");
    drop(one);
    three.share_texture(picture, &shared).expect("nobody has it any more");
}

pub fn another_engine_knows_what_is_written(engine: &mut Engine) {
    let (plan, picture) = writing();
    let usages = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
    let shared = texture(engine, usages);
    let mut other = Engine::new(engine.gpu().clone());
    let (mut one, mut two) = (prepare(engine, plan.clone()), prepare(&mut other, plan.clone()));
    one.share_texture(picture, &shared).unwrap();
    assert!(two.share_texture(picture, &shared).is_err(), "the device is the same");
    // Neither what the other made for itself.
    let own = prepare(engine, writing().0);
    let refused = two.share(picture, &own, ObjectRef::Fixed(picture));
    assert!(refused.is_err(), "both write");
    // A plan that only reads what the one before it wrote lets go of it.
    let mut reads = plan.clone();
    reads.passes.clear();
    let one = engine.prepare(reads, Some(one)).unwrap();
    two.share_texture(picture, &shared).expect("nobody writes it any more");
    // And one that writes again is refused, with the runner before intact.
    let refused = engine.prepare(plan, Some(one)).unwrap_err();
    assert!(refused.diagnostics.iter().any(|d| d.message.contains("written already")), "{:?}", refused.diagnostics);
    assert!(refused.previous.is_some());
}

/// Instances of a graph on one device: pipelines are made once, and an input is in memory once.
pub fn instances_share_pipelines_and_inputs(engine: &mut Engine) {
    let (plan, picture, out) = reading();
    let mut one = prepare(engine, plan.clone());
    assert_eq!((one.build_report().pipelines_built, one.build_report().pipelines_reused), (1, 0));
    let mut two: Vec<Runner> = (0..2).map(|_| prepare(engine, plan.clone())).collect();
    for runner in &two {
        assert_eq!((runner.build_report().pipelines_built, runner.build_report().pipelines_reused), (0, 1));
    }
    let shared = filled(engine, 7.0);
    for runner in two.iter_mut().chain([&mut one]) {
        runner.share_texture(picture, &shared).unwrap();
        run(engine, runner);
        assert_eq!(words(engine, runner, out), [7]);
        assert_eq!(runner.memory_bytes(), 4, "the picture is not its own");
    }
}

/// Of no pixels but one, and of as many as the device has: here one that validates and stores
/// nothing.
pub fn the_smallest_and_the_largest_sizes_work(_: &mut Engine) {
    let descriptor = wgpu::DeviceDescriptor { required_limits: wgpu::Limits::default(), ..Default::default() };
    let (device, queue) = wgpu::Device::noop(&descriptor);
    let most = device.limits().max_texture_dimension_2d;
    let mut engine = Engine::new(Gpu::from_parts(None, device, queue));
    let mut runner = None;
    for (side, is_possible) in [(64, true), (1, true), (most, true), (most + 1, false), (64, true)] {
        let mut plan = new_plan();
        let picture = plan.texture("picture", TextureFormat::Rgba8Unorm, side, side);
        plan.pass("clear", PassKind::Clear { view: plan.whole(picture), value: [1.0; 4] });
        match engine.prepare(plan, runner.take()) {
            Ok(mut made) => {
                assert!(is_possible, "{side}");
                made.run(&engine, &frame()).unwrap();
                runner = Some(made);
            }
            Err(refused) => {
                assert!(!is_possible, "{side}: {:?}", refused.diagnostics);
                assert!(refused.diagnostics.iter().any(|d| d.message.contains("`picture`")));
                runner = refused.previous;
                assert!(runner.as_mut().is_some_and(|before| before.run(&engine, &frame()).is_ok()));
            }
        }
    }
}
