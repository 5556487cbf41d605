//! Clears, copies, mips.

use meniscus::engine::Engine;
use meniscus::format::TextureFormat;
use meniscus::plan::model::*;
use meniscus::shader::reflect::{Scalar, Type};
use wgpu_types::TextureUsages;

use crate::support::*;

pub fn clears_touch_only_their_view(engine: &mut Engine) {
    use TextureFormat as F;
    // The last ones cannot be targets.
    for format in [F::Rgba8Unorm, F::Rgba32Float, F::R32Uint, F::R16Float, F::Rgba8Snorm] {
        let mut plan = new_plan();
        let about = Texture { layers: 3, mips: 2, ..texture(format, 8, 4) };
        let object = plan.texture_as("t", about);
        plan.pass("all", PassKind::Clear { view: plan.whole(object), value: [0.0; 4] });
        let part = view(&plan, object, Some(1), Some(2));
        plan.pass("part", PassKind::Clear { view: part, value: [1.0; 4] });
        let mut runner = prepare(engine, plan);
        run(engine, &mut runner);
        for (mip, layer) in [(0, 0), (0, 2), (1, 1), (1, 2)] {
            let texels = texels(engine, &runner, object, mip, layer);
            let expected = if (mip, layer) == (1, 2) { 1.0 } else { 0.0 };
            assert_eq!(texels.len(), if mip == 0 { 32 } else { 8 });
            assert!(texels.iter().all(|t| t[0] == expected), "{format:?} {mip} {layer}: {texels:?}");
        }
    }
}

pub fn volumes_are_cleared_slice_by_slice(engine: &mut Engine) {
    let mut plan = new_plan();
    let usages = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
    let about = Texture { layers: 5, is_3d: true, mips: 2, usages, ..texture(TextureFormat::Rgba16Float, 6, 4) };
    let object = plan.texture_as("volume", about);
    plan.pass("clear", PassKind::Clear { view: plan.whole(object), value: [0.5, 1.0, -2.0, 4.0] });
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    for (mip, texels) in [(0, 6 * 4 * 5), (1, 3 * 2 * 2)] {
        let data = runner.read_texture(engine, ObjectRef::Fixed(object), mip, None).unwrap().to_rgba_f32();
        assert_eq!(data.len(), texels);
        assert!(data.iter().all(|t| *t == [0.5, 1.0, -2.0, 4.0]));
    }
}

pub fn depth_is_cleared(engine: &mut Engine) {
    let mut plan = new_plan();
    let object = plan.texture_as("d", Texture { layers: 2, ..texture(TextureFormat::Depth32Float, 4, 4) });
    plan.pass("one", PassKind::Clear { view: view(&plan, object, Some(0), Some(1)), value: [0.75, 0.0, 0.0, 0.0] });
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    assert!(texels(engine, &runner, object, 0, 1).iter().all(|t| t[0] == 0.75));
    assert!(texels(engine, &runner, object, 0, 0).iter().all(|t| t[0] == 0.0));
}

pub fn buffers_clear_to_words_of_their_type(engine: &mut Engine) {
    let mut plan = new_plan();
    let ids: Vec<_> = [(Scalar::F32, 2.5, 2.5f32.to_bits()), (Scalar::I32, -3.0, u32::MAX - 2), (Scalar::U32, 7.0, 7)]
        .into_iter()
        .enumerate()
        .map(|(i, (scalar, value, expected))| {
            let id = plan.buffer(&format!("b{i}"), 1000);
            if let ObjectKind::Buffer(b) = &mut plan.objects[id].kind {
                b.item = Some(Type::Scalar(scalar));
            }
            plan.pass(&format!("clear{i}"), PassKind::Clear { view: plan.whole(id), value: [value; 4] });
            (id, expected)
        })
        .collect();
    let zeroed = plan.buffer("zeroed", 10);
    plan.pass("fill", PassKind::Clear { view: plan.whole(zeroed), value: [5.0; 4] });
    plan.pass("zero", PassKind::Clear { view: plan.whole(zeroed), value: [0.0; 4] });
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    for (id, expected) in ids {
        assert_eq!(words(engine, &runner, id), vec![expected; 1000]);
    }
    assert_eq!(words(engine, &runner, zeroed), [0; 10]);
}

/// Colours each layer of a mip by its number.
fn numbered(plan: &mut Plan, object: ObjectId, mip: u32) {
    let ObjectKind::Texture(t) = &plan.objects[object].kind else { panic!("no texture") };
    for layer in 0..t.layers {
        let value = [f64::from(layer + 1); 4];
        plan.pass(
            &format!("n{object}.{layer}"),
            PassKind::Clear { view: view(plan, object, Some(mip), Some(layer)), value },
        );
    }
}

pub fn copies_of_views_and_buffers(engine: &mut Engine) {
    let mut plan = new_plan();
    let from = plan.texture_as("from", Texture { layers: 3, ..texture(TextureFormat::R32Float, 4, 4) });
    let to = plan.texture_as("to", Texture { layers: 2, mips: 2, ..texture(TextureFormat::R32Float, 8, 8) });
    let (a, b) = (plan.buffer("a", 100), plan.buffer("b", 60));
    numbered(&mut plan, from, 0);
    plan.pass("clear", PassKind::Clear { view: plan.whole(to), value: [0.0; 4] });
    plan.pass("fill", PassKind::Clear { view: plan.whole(a), value: [6.0; 4] });
    // Layers 1 and 2 go to mip 1 of layers 0 and 1.
    let source = View { layers: 1..3, ..plan.whole(from) };
    let target = View { mips: 1..2, ..plan.whole(to) };
    plan.pass("copy", PassKind::Copy { from: source, to: target });
    plan.pass("buffers", PassKind::Copy { from: plan.whole(a), to: plan.whole(b) });
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    for (mip, layer, expected) in [(0, 0, 0.0), (1, 0, 2.0), (1, 1, 3.0)] {
        assert!(texels(engine, &runner, to, mip, layer).iter().all(|t| t[0] == expected), "{mip} {layer}");
    }
    assert_eq!(words(engine, &runner, b), [6; 60]);
}

/// Mip 0 of one layer: x + 10 y + 100 layer.
fn ramp(engine: &Engine, runner: &mut meniscus::engine::Runner, object: ObjectId, size: [u32; 3]) {
    for layer in 0..size[2] {
        let texels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x + 10 * y + 100 * layer) as f32));
        let bytes: Vec<u8> = texels.flat_map(f32::to_le_bytes).collect();
        runner.upload_texture(engine, object, 0, layer, &bytes).unwrap();
    }
}

/// The mean of the ramp, which every mip must keep.
fn mean(texels: &[[f32; 4]]) -> f32 {
    texels.iter().map(|t| t[0]).sum::<f32>() / texels.len() as f32
}

fn mips_of(engine: &mut Engine, width: u32, height: u32, layers: u32) {
    let mut plan = new_plan();
    let mips = 32 - width.max(height).leading_zeros();
    let about = Texture { layers, mips, ..texture(TextureFormat::R32Float, width, height) };
    let object = plan.texture_as("t", about);
    plan.objects[object].origin = Origin::Input("t".into());
    plan.pass("mips", PassKind::Mips { texture: ObjectRef::Fixed(object) });
    let mut runner = prepare(engine, plan);
    ramp(engine, &mut runner, object, [width, height, layers]);
    run(engine, &mut runner);
    for layer in 0..layers {
        let expected = mean(&texels(engine, &runner, object, 0, layer));
        for mip in 1..mips {
            let texels = texels(engine, &runner, object, mip, layer);
            assert_eq!(texels.len() as u32, (width >> mip).max(1) * (height >> mip).max(1));
            let found = mean(&texels);
            assert!((found - expected).abs() < 1e-3, "{width} x {height}, {mip} {layer}: {found} for {expected}");
        }
    }
}

pub fn mips_keep_the_mean_of_each_layer(engine: &mut Engine) {
    // An array, a cube, and sizes that do not halve.
    mips_of(engine, 16, 8, 3);
    mips_of(engine, 8, 8, 6);
    mips_of(engine, 13, 7, 1);
}

pub fn mips_of_two_by_two_are_their_mean(engine: &mut Engine) {
    let mut plan = new_plan();
    let about = Texture { mips: 2, ..texture(TextureFormat::R32Float, 4, 2) };
    let object = plan.texture_as("t", about);
    plan.objects[object].origin = Origin::Input("t".into());
    plan.pass("mips", PassKind::Mips { texture: ObjectRef::Fixed(object) });
    let mut runner = prepare(engine, plan);
    ramp(engine, &mut runner, object, [4, 2, 1]);
    run(engine, &mut runner);
    let reds: Vec<f32> = texels(engine, &runner, object, 1, 0).iter().map(|t| t[0]).collect();
    assert_eq!(reds, [5.5, 7.5]);
}

pub fn mips_of_volumes_are_stored(engine: &mut Engine) {
    let mut plan = new_plan();
    let about = Texture { layers: 4, is_3d: true, mips: 3, ..texture(TextureFormat::R32Float, 8, 4) };
    let object = plan.texture_as("volume", Texture { usages: TextureUsages::TEXTURE_BINDING, ..about });
    plan.objects[object].origin = Origin::Input("volume".into());
    plan.pass("mips", PassKind::Mips { texture: ObjectRef::Fixed(object) });
    let mut runner = prepare(engine, plan);
    ramp(engine, &mut runner, object, [8, 4, 4]);
    run(engine, &mut runner);
    let read = |engine: &mut Engine, mip| {
        runner.read_texture(engine, ObjectRef::Fixed(object), mip, None).unwrap().to_rgba_f32()
    };
    let expected = mean(&read(engine, 0));
    // (0 + 1 + 10 + 11 + 100 + 101 + 110 + 111) / 8
    assert_eq!(read(engine, 1)[0][0], 55.5);
    assert_eq!(read(engine, 2).len(), 2);
    assert!((mean(&read(engine, 2)) - expected).abs() < 1e-3);
}
