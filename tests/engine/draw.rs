//! Draws: targets, blending, depth, stencil, samples, regions.

use meniscus::engine::Engine;
use meniscus::format::TextureFormat;
use meniscus::graph::model::{Blend, BlendComponent, Compare, Factor, Operation, StencilOperation, Topology};
use meniscus::plan::model::*;
use wgpu_types::{BufferUsages, Features, TextureUsages};

use crate::support::*;

const UV: &str = "
@fragment fn fs(@location(0) uv: vec2<f32>) -> @location(0) vec4<f32> { return vec4<f32>(uv, 0.25, 1.0); }";

pub fn fullscreen_has_uv_from_the_top_left(engine: &mut Engine) {
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::Rgba32Float, 4, 2);
    let mut draw = plan.draw("uv", UV, &[], Geometry::Fullscreen);
    draw.color = vec![ColorTarget { discard_before: true, ..target(&plan, color, None) }];
    plan.pass("uv", PassKind::Draw(Box::new(draw)));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    let texels = texels(engine, &runner, color, 0, 0);
    assert_eq!(texels[0], [0.125, 0.25, 0.25, 1.0]);
    assert_eq!(texels[3], [0.875, 0.25, 0.25, 1.0]);
    assert_eq!(texels[4], [0.125, 0.75, 0.25, 1.0]);
}

/// A triangle over everything, its instance's number as colour, depth 1 / (instance + 2).
const LAYERS: &str = "
struct Corner { @builtin(position) p: vec4<f32>, @location(0) @interpolate(flat) i: u32 }
@vertex fn vs(@builtin(vertex_index) v: u32, @builtin(instance_index) i: u32) -> Corner {
    let c = vec2<f32>(f32((v << 1u) & 2u), f32(v & 2u));
    return Corner(vec4<f32>(c * 2.0 - 1.0, 1.0 / f32(i + 2u), 1.0), i);
}
@fragment fn fs(in: Corner) -> @location(0) vec4<f32> { return vec4<f32>(f32(in.i + 1u), 0.5, 0.0, 1.0); }";

fn add() -> Blend {
    let one = BlendComponent { source: Factor::One, target: Factor::One, operation: Operation::Add };
    Blend { color: one, alpha: one }
}

pub fn two_draws_add_into_32_bit_floats(engine: &mut Engine) {
    assert!(engine.gpu().features().contains(Features::FLOAT32_BLENDABLE), "this device cannot");
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::Rgba32Float, 8, 8);
    for (name, clear, instances) in [("first", Some([0.25, 0.0, 0.0, 0.0]), 2), ("second", None, 3)] {
        let mut draw = plan.draw(name, LAYERS, &[], Geometry::Direct { vertices: 3, instances });
        draw.color = vec![ColorTarget { blend: Some(add()), ..target(&plan, color, clear) }];
        plan.pass(name, PassKind::Draw(Box::new(draw)));
    }
    let mut runner = prepare(engine, plan);
    assert_eq!(runner.build_report().draws_joined, 1);
    // Each in a render pass of its own, then both in one.
    for timed in [true, false] {
        runner.time_passes(timed);
        let report = run(engine, &mut runner);
        assert_eq!(report.passes.iter().map(|p| p.gpu_ms.is_some()).collect::<Vec<_>>(), [timed; 2]);
        // 0.25 + (1 + 2) + (1 + 2 + 3)
        assert!(texels(engine, &runner, color, 0, 0).iter().all(|t| *t == [9.25, 2.5, 0.0, 5.0]));
    }
}

pub fn minimum_and_masks_hold(engine: &mut Engine) {
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::Rgba16Float, 2, 2);
    let least = BlendComponent { source: Factor::Zero, target: Factor::SrcAlpha, operation: Operation::Min };
    let mut draw = plan.draw("least", LAYERS, &[], Geometry::Direct { vertices: 3, instances: 2 });
    draw.color = vec![ColorTarget {
        blend: Some(Blend { color: least, alpha: least }),
        write: [true, false, true, true],
        ..target(&plan, color, Some([5.0, 7.0, 7.0, 7.0]))
    }];
    plan.pass("least", PassKind::Draw(Box::new(draw)));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    assert_eq!(texels(engine, &runner, color, 0, 0)[0], [1.0, 7.0, 0.0, 1.0]);
}

pub fn several_targets_of_several_kinds(engine: &mut Engine) {
    const WGSL: &str = "
struct Out { @location(0) a: vec4<f32>, @location(1) b: vec2<u32>, @location(2) c: f32 }
@fragment fn fs(@builtin(position) p: vec4<f32>) -> Out {
    return Out(vec4<f32>(1.0, 0.0, 0.5, 1.0), vec2<u32>(p.xy), p.x * 10.0);
}";
    let mut plan = new_plan();
    let a = plan.texture("a", TextureFormat::Rgba8Unorm, 3, 2);
    let b = plan.texture("b", TextureFormat::Rg32Uint, 3, 2);
    let layered = Texture { layers: 2, mips: 2, ..texture(TextureFormat::R32Float, 6, 4) };
    let c = plan.texture_as("c", layered);
    let mut draw = plan.draw("all", WGSL, &[], Geometry::Fullscreen);
    let into = ColorTarget { view: view(&plan, c, Some(1), Some(1)), ..target(&plan, c, Some([0.0; 4])) };
    draw.color = vec![target(&plan, a, Some([0.0; 4])), target(&plan, b, Some([0.0; 4])), into];
    plan.pass("all", PassKind::Draw(Box::new(draw)));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    assert_eq!(texels(engine, &runner, a, 0, 0)[5][..2], [1.0, 0.0]);
    assert_eq!(texels(engine, &runner, b, 0, 0)[5][..2], [2.0, 1.0]);
    let reds: Vec<f32> = texels(engine, &runner, c, 1, 1).iter().map(|t| t[0]).collect();
    assert_eq!(reds, [5.0, 15.0, 25.0, 5.0, 15.0, 25.0]);
    assert!(texels(engine, &runner, c, 1, 0).iter().all(|t| t[0] == 0.0), "the other layer is not touched");
}

/// Draws three layers and gives the colour and depth that are left.
fn with_depth(engine: &mut Engine, compare: Compare, clear: f32, format: TextureFormat) -> (f32, f32) {
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::R32Float, 4, 4);
    let buffer = plan.texture("depth", format, 4, 4);
    let mut draw = plan.draw("layers", LAYERS, &[], Geometry::Direct { vertices: 3, instances: 3 });
    draw.color = vec![target(&plan, color, Some([0.0; 4]))];
    draw.depth = Some(depth(&plan, buffer, compare, Some(clear)));
    plan.pass("layers", PassKind::Draw(Box::new(draw)));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    let (color, depth) = (texels(engine, &runner, color, 0, 0), texels(engine, &runner, buffer, 0, 0));
    assert_eq!(depth.len(), 16);
    (color[5][0], depth[5][0])
}

pub fn nearest_and_farthest_of_reversed_depth(engine: &mut Engine) {
    use TextureFormat as F;
    for format in [F::Depth32Float, F::Depth24Plus, F::Depth16Unorm, F::Depth24PlusStencil8, F::Depth32FloatStencil8] {
        if !engine.gpu().features().contains(format.required_features()) {
            continue;
        }
        let (color, depth) = with_depth(engine, Compare::Greater, 0.0, format);
        assert_eq!(color, 1.0, "{format:?}");
        assert!((depth - 0.5).abs() < 2e-5, "{format:?}: {depth}");
        let (color, depth) = with_depth(engine, Compare::Less, 1.0, format);
        assert_eq!(color, 3.0, "{format:?}");
        assert!((depth - 0.25).abs() < 2e-5, "{format:?}: {depth}");
    }
}

pub fn depth_is_tested_and_sampled_in_one_pass(engine: &mut Engine) {
    const READ: &str = "
var d: texture_depth_2d;
@vertex fn vs(@builtin(vertex_index) v: u32) -> @builtin(position) vec4<f32> {
    let c = vec2<f32>(f32((v << 1u) & 2u), f32(v & 2u));
    return vec4<f32>(c * 2.0 - 1.0, 0.375, 1.0);
}
@fragment fn fs(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(textureLoad(d, vec2<u32>(p.xy), 0));
}";
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::R32Float, 4, 4);
    let buffer = plan.texture("depth", TextureFormat::Depth32Float, 4, 4);
    // Depth only, in the left half.
    let mut only = plan.draw("only", LAYERS, &[], Geometry::Direct { vertices: 3, instances: 1 });
    only.shader.fragment = None;
    only.depth = Some(depth(&plan, buffer, Compare::Greater, Some(0.25)));
    only.region = Some([0, 0, 2, 4]);
    plan.pass("only", PassKind::Draw(Box::new(only)));
    let bound = [("d", sampled(&plan, buffer))];
    let mut read = plan.draw("read", READ, &bound, Geometry::Direct { vertices: 3, instances: 1 });
    read.color = vec![target(&plan, color, Some([-1.0; 4]))];
    read.depth = Some(DepthTarget { write: false, ..depth(&plan, buffer, Compare::GreaterEqual, None) });
    plan.pass("read", PassKind::Draw(Box::new(read)));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    let reds: Vec<f32> = texels(engine, &runner, color, 0, 0)[..4].iter().map(|t| t[0]).collect();
    assert_eq!(reds, [-1.0, -1.0, 0.25, 0.25]);
}

pub fn stencil_marks_and_masks(engine: &mut Engine) {
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::R32Float, 4, 4);
    let buffer = plan.texture("stencil", TextureFormat::Depth24PlusStencil8, 4, 4);
    let keep = StencilOperation::Keep;
    let mark = Stencil {
        compare: Compare::Always,
        pass: StencilOperation::Replace,
        fail: keep,
        depth_fail: keep,
        reference: 7,
        read_mask: 255,
        write_mask: 255,
        clear: Some(1),
    };
    let passes = [
        ("mark", Some([2, 0, 2, 4]), Some(0.0), mark.clone(), true),
        (
            "masked",
            None,
            None,
            Stencil { compare: Compare::Equal, pass: keep, write_mask: 0, clear: None, ..mark },
            false,
        ),
    ];
    for (name, region, clear, stencil, first) in passes {
        let mut draw = plan.draw(name, LAYERS, &[], Geometry::Direct { vertices: 3, instances: 1 });
        if first {
            draw.shader.fragment = None;
        } else {
            draw.color = vec![target(&plan, color, Some([-1.0; 4]))];
        }
        let tested = depth(&plan, buffer, Compare::Always, clear);
        draw.depth = Some(DepthTarget { write: false, stencil: Some(stencil), ..tested });
        draw.region = region;
        plan.pass(name, PassKind::Draw(Box::new(draw)));
    }
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    let reds: Vec<f32> = texels(engine, &runner, color, 0, 0)[..4].iter().map(|t| t[0]).collect();
    assert_eq!(reds, [-1.0, -1.0, 1.0, 1.0]);
}

pub fn samples_are_resolved(engine: &mut Engine) {
    /// Covers what is left of x = 0.
    const HALF: &str = "
@vertex fn vs(@builtin(vertex_index) v: u32) -> @builtin(position) vec4<f32> {
    let c = array(vec2<f32>(-1.0, -1.0), vec2<f32>(0.0, -1.0), vec2<f32>(-1.0, 1.0), vec2<f32>(0.0, 1.0));
    return vec4<f32>(c[v], 0.5, 1.0);
}
@fragment fn fs() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }";
    let mut plan = new_plan();
    // Of three pixels, the edge runs through the middle one.
    let usages = TextureUsages::RENDER_ATTACHMENT;
    let many = Texture { samples: 4, usages, ..texture(TextureFormat::Rgba8Unorm, 3, 1) };
    let many = plan.texture_as("many", many);
    let one = plan.texture("one", TextureFormat::Rgba8Unorm, 3, 1);
    let mut draw = plan.draw("half", HALF, &[], Geometry::Direct { vertices: 4, instances: 1 });
    let into = view(&plan, one, Some(0), Some(0));
    draw.color = vec![ColorTarget { resolve: Some(into), ..target(&plan, many, Some([0.0; 4])) }];
    draw.samples = 4;
    draw.topology = Topology::TriangleStrip;
    plan.pass("half", PassKind::Draw(Box::new(draw)));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    let reds: Vec<f32> = texels(engine, &runner, one, 0, 0).iter().map(|t| t[0]).collect();
    assert_eq!([reds[0], reds[2]], [1.0, 0.0]);
    assert!((reds[1] - 0.5).abs() < 0.01, "{reds:?}");
    let many = ObjectRef::Fixed(many);
    assert!(runner.read_texture(engine, many, 0, None).is_err(), "samples cannot be read back");
}

pub fn a_region_is_viewport_and_scissor(engine: &mut Engine) {
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::Rgba32Float, 4, 4);
    let mut draw = plan.draw("uv", UV, &[], Geometry::Fullscreen);
    draw.color = vec![target(&plan, color, Some([9.0; 4]))];
    draw.region = Some([1, 2, 2, 2]);
    plan.pass("uv", PassKind::Draw(Box::new(draw)));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    let texels = texels(engine, &runner, color, 0, 0);
    assert_eq!(texels[0], [9.0; 4], "a clear is of the whole target");
    assert_eq!(texels[2 * 4 + 1][..2], [0.25, 0.25], "uv is that of the region");
    assert_eq!(texels[3 * 4 + 2][..2], [0.75, 0.75]);
    assert_eq!(texels[2 * 4 + 3], [9.0; 4]);
}

pub fn nothing_to_draw_still_clears(engine: &mut Engine) {
    let mut plan = new_plan();
    let mut colors = Vec::new();
    let none = [
        Geometry::Direct { vertices: 0, instances: 1 },
        Geometry::Direct { vertices: 3, instances: 0 },
        Geometry::Indirect { slot: 5, indices: None },
    ];
    for (i, geometry) in none.into_iter().enumerate() {
        let color = plan.texture(&format!("color{i}"), TextureFormat::R32Float, 2, 2);
        let mut draw = plan.draw("none", LAYERS, &[], geometry);
        draw.color = vec![target(&plan, color, Some([4.0; 4]))];
        plan.pass(&format!("none{i}"), PassKind::Draw(Box::new(draw)));
        colors.push(color);
    }
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    for color in colors {
        assert!(texels(engine, &runner, color, 0, 0).iter().all(|t| t[0] == 4.0));
    }
}

/// Points at pixel (vertex, instance).
const POINTS: &str = "
@vertex fn vs(@builtin(vertex_index) v: u32, @builtin(instance_index) i: u32) -> @builtin(position) vec4<f32> {
    let at = (vec2<f32>(f32(v), f32(i)) + 0.5) / 4.0;
    return vec4<f32>(at.x * 2.0 - 1.0, 1.0 - at.y * 2.0, 0.5, 1.0);
}
@fragment fn fs() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }";

/// Which pixels of 4 x 4 were hit.
fn hits(engine: &mut Engine, runner: &Runner, color: ObjectId) -> Vec<usize> {
    let texels = texels(engine, runner, color, 0, 0);
    texels.iter().enumerate().filter(|(_, t)| t[0] == 1.0).map(|(i, _)| i).collect()
}

use meniscus::engine::Runner;

pub fn indices_choose_vertices(engine: &mut Engine) {
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::R32Float, 4, 4);
    let indices = plan.buffer("indices", 3);
    plan.objects[indices].origin = Origin::Input("indices".into());
    let geometry = Geometry::Indexed { indices: ObjectRef::Fixed(indices), count: 2, instances: 2 };
    let mut draw = plan.draw("points", POINTS, &[], geometry);
    draw.topology = Topology::PointList;
    draw.color = vec![target(&plan, color, Some([0.0; 4]))];
    plan.pass("points", PassKind::Draw(Box::new(draw)));
    let mut runner = prepare(engine, plan);
    let bytes: Vec<u8> = [3u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()).collect();
    runner.upload_buffer(engine, indices, &bytes).unwrap();
    run(engine, &mut runner);
    assert_eq!(hits(engine, &runner, color), [1, 3, 5, 7]);
}

pub fn counts_drive_draws(engine: &mut Engine) {
    const APPEND: &str = "
struct Out { count: atomic<u32>, items: array<u32> }
var<storage, read_write> out: Out;
@compute @workgroup_size(1) fn main() { atomicAdd(&out.count, 3u); }";
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::R32Float, 4, 4);
    let list = plan.counted("list", 16);
    plan.pass("clear", PassKind::Clear { view: plan.whole(list), value: [0.0; 4] });
    plan.compute("append", APPEND, &[("out", storage(list))], Dispatch::Groups([1, 1, 1]));
    let kind = ArgumentKind::Draw { vertices: Some(2), instances: None, indexed: false };
    let arguments = vec![Argument { slot: 1, kind }];
    plan.pass("settle", PassKind::Settle { counted: ObjectRef::Fixed(list), arguments });
    let mut draw = plan.draw("points", POINTS, &[], Geometry::Indirect { slot: 1, indices: None });
    draw.topology = Topology::PointList;
    draw.color = vec![target(&plan, color, Some([0.0; 4]))];
    plan.pass("points", PassKind::Draw(Box::new(draw)));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    assert_eq!(hits(engine, &runner, color), [0, 1, 4, 5, 8, 9]);
}

pub fn a_shader_writes_draw_arguments(engine: &mut Engine) {
    const WRITE: &str = "
var<storage, read_write> arguments: array<u32>;
@compute @workgroup_size(1) fn main() {
    // The second item: 2 vertices from 1, 2 instances; a first instance that must not be taken.
    arguments[4] = 2u; arguments[5] = 2u; arguments[6] = 1u; arguments[7] = 2u;
}";
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::R32Float, 4, 4);
    let arguments = plan.buffer("arguments", 8);
    if let ObjectKind::Buffer(b) = &mut plan.objects[arguments].kind {
        b.usages |= BufferUsages::STORAGE;
    }
    plan.compute("write", WRITE, &[("arguments", storage(arguments))], Dispatch::Groups([1, 1, 1]));
    let from = ObjectRef::Fixed(arguments);
    plan.pass("copied", PassKind::Arguments { from, offset: 16, indexed: false, slot: 2 });
    let mut draw = plan.draw("points", POINTS, &[], Geometry::Indirect { slot: 2, indices: None });
    draw.topology = Topology::PointList;
    draw.color = vec![target(&plan, color, Some([0.0; 4]))];
    plan.pass("points", PassKind::Draw(Box::new(draw)));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    assert_eq!(hits(engine, &runner, color), [1, 2, 5, 6]);
}

/// Equal targets, but the second draw reads what the first wrote: a buffer, or the depth.
pub fn draws_that_need_each_other_share_no_render_pass(engine: &mut Engine) {
    const WRITE: &str = "
var<storage, read_write> note: array<u32>;
@vertex fn vs(@builtin(vertex_index) v: u32) -> @builtin(position) vec4<f32> {
    let c = vec2<f32>(f32((v << 1u) & 2u), f32(v & 2u));
    return vec4<f32>(c * 2.0 - 1.0, 0.75, 1.0);
}
@fragment fn fs() -> @location(0) vec4<f32> { note[0] = 5u; return vec4<f32>(1.0); }";
    const READ: &str = "
var<storage, read> note: array<u32>;
var d: texture_depth_2d;
@vertex fn vs(@builtin(vertex_index) v: u32) -> @builtin(position) vec4<f32> {
    let c = vec2<f32>(f32((v << 1u) & 2u), f32(v & 2u));
    return vec4<f32>(c * 2.0 - 1.0, 0.75, 1.0);
}
@fragment fn fs(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(f32(note[0]), textureLoad(d, vec2<u32>(p.xy), 0), 0.0, 0.0);
}";
    let mut plan = new_plan();
    let color = plan.texture("color", TextureFormat::Rgba32Float, 4, 4);
    let buffer = plan.texture("depth", TextureFormat::Depth32Float, 4, 4);
    let note = plan.buffer("note", 1);
    let three = || Geometry::Direct { vertices: 3, instances: 1 };
    let mut write = plan.draw("write", WRITE, &[("note", storage(note))], three());
    for binding in &mut write.shader.bindings {
        binding.stages = wgpu_types::ShaderStages::FRAGMENT;
    }
    write.color = vec![target(&plan, color, Some([0.0; 4]))];
    write.depth = Some(depth(&plan, buffer, Compare::Greater, Some(0.0)));
    plan.pass("write", PassKind::Draw(Box::new(write)));
    let bound = [("note", read_only(note)), ("d", sampled(&plan, buffer))];
    let mut read = plan.draw("read", READ, &bound, three());
    read.color = vec![ColorTarget { blend: Some(add()), ..target(&plan, color, None) }];
    read.depth = Some(DepthTarget { write: false, ..depth(&plan, buffer, Compare::GreaterEqual, None) });
    plan.pass("read", PassKind::Draw(Box::new(read)));
    let mut runner = prepare(engine, plan);
    assert_eq!(runner.build_report().draws_joined, 0);
    runner.time_passes(false);
    run(engine, &mut runner);
    assert!(texels(engine, &runner, color, 0, 0).iter().all(|t| *t == [6.0, 1.75, 1.0, 1.0]));
}
