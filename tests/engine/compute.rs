//! Dispatches, counted buffers and what follows from counts.

use meniscus::engine::{Engine, Gpu, GpuOptions};
use meniscus::plan::model::*;

use crate::support::*;

const DOUBLE: &str = "
var<storage, read> source: array<u32>;
var<storage, read_write> result: array<u32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&result) { result[id.x] = 2u * source[id.x] + 1u; }
}";

pub fn reads_and_writes_buffers(engine: &mut Engine) {
    let mut plan = new_plan();
    let (source, result) = (plan.buffer("source", 100), plan.buffer("result", 100));
    plan.objects[source].origin = Origin::Input("source".into());
    let bound = [("source", read_only(source)), ("result", storage(result))];
    plan.compute("double", DOUBLE, &bound, Dispatch::Groups([2, 1, 1]));
    let mut runner = prepare(engine, plan);
    let bytes: Vec<u8> = (0..100u32).flat_map(u32::to_le_bytes).collect();
    runner.upload_buffer(engine, source, &bytes).unwrap();
    run(engine, &mut runner);
    assert_eq!(words(engine, &runner, result), (0..100).map(|i| 2 * i + 1).collect::<Vec<_>>());
    assert!(runner.upload_buffer(engine, source, &[0; 404]).is_err(), "more than there is room for");
}

pub fn zero_workgroups_are_skipped(engine: &mut Engine) {
    let mut plan = new_plan();
    let (source, result) = (plan.buffer("source", 4), plan.buffer("result", 4));
    let bound = [("source", read_only(source)), ("result", storage(result))];
    plan.compute("double", DOUBLE, &bound, Dispatch::Groups([0, 1, 1]));
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    assert_eq!(words(engine, &runner, result), [0; 4]);
}

/// The linear index of a dispatch that may be folded into rows.
const COUNT_THREADS: &str = "
var<storage, read_write> seen: array<atomic<u32>>;
@compute @workgroup_size(1)
fn main(@builtin(workgroup_id) id: vec3<u32>, @builtin(num_workgroups) n: vec3<u32>) {
    let index = id.y * n.x + id.x;
    atomicAdd(&seen[0], 1u);
    atomicMax(&seen[1], index);
    if index < 70000u { atomicAdd(&seen[2], 1u); }
}";

const APPEND: &str = "
struct Out { count: atomic<u32>, items: array<u32> }
var<storage, read_write> out: Out;
override wanted: u32 = 0u;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) n: vec3<u32>) {
    let index = id.y * n.x * 64u + id.x;
    if index >= wanted { return; }
    let at = atomicAdd(&out.count, 1u);
    if at < arrayLength(&out.items) { out.items[at] = index; }
}";

/// Clear, append so many, settle, dispatch over what there is.
fn counting(engine: &mut Engine, wanted: u32, capacity: u64, threads: u32) -> (Vec<u32>, Vec<u32>, u32) {
    let mut plan = new_plan();
    let (list, seen) = (plan.counted("list", capacity), plan.buffer("seen", 3));
    plan.pass("clear", PassKind::Clear { view: plan.whole(list), value: [0.0; 4] });
    plan.pass("clear_seen", PassKind::Clear { view: plan.whole(seen), value: [0.0; 4] });
    let groups = Dispatch::Groups([wanted.div_ceil(64).clamp(1, 1000), 20, 1]);
    let append = plan.compute("append", APPEND, &[("out", storage(list))], groups);
    if let PassKind::Compute { shader, .. } = &mut plan.passes[append].kind {
        shader.constants.push(("wanted".into(), f64::from(wanted)));
    }
    let arguments = vec![Argument { slot: 3, kind: ArgumentKind::Dispatch { threads } }];
    plan.pass("settle", PassKind::Settle { counted: ObjectRef::Fixed(list), arguments });
    plan.compute("consume", COUNT_THREADS, &[("seen", storage(seen))], Dispatch::Indirect { slot: 3 });
    let mut runner = prepare(engine, plan);
    run(engine, &mut runner);
    let report = run(engine, &mut runner);
    assert!(report.complete);
    let [count] = &report.counts[..] else { panic!("one counted buffer: {report:?}") };
    assert_eq!((count.path.as_str(), count.capacity), ("list", capacity));
    assert_eq!(count.overflowed(), u64::from(wanted) > capacity);
    (words(engine, &runner, list), words(engine, &runner, seen), count.raw)
}

pub fn counts_drive_dispatches(engine: &mut Engine) {
    let (list, seen, raw) = counting(engine, 100, 128, 16);
    assert_eq!((list[0], raw), (100, 100));
    let mut items = list[1..101].to_vec();
    items.sort_unstable();
    assert_eq!(items, (0..100).collect::<Vec<_>>());
    assert_eq!(seen, [7, 6, 7]);
}

pub fn an_overflow_is_clamped_and_told(engine: &mut Engine) {
    let (list, seen, raw) = counting(engine, 300, 128, 1);
    assert_eq!((list[0], raw), (128, 300));
    assert_eq!(seen, [128, 127, 128]);
}

pub fn a_count_of_zero_dispatches_nothing(engine: &mut Engine) {
    let (list, seen, raw) = counting(engine, 0, 16, 1);
    assert_eq!((list[0], raw), (0, 0));
    assert_eq!(seen, [0, 0, 0]);
}

pub fn more_than_65535_groups_are_folded(engine: &mut Engine) {
    let (list, seen, raw) = counting(engine, 70_000, 80_000, 1);
    assert_eq!((list[0], raw), (70_000, 70_000));
    // Two rows of 65,535: every index once, the rest of the second row beyond the count.
    assert_eq!(seen, [131_070, 131_069, 70_000]);
}

/// Dispatches that follow each other share a compute pass, what is none parts them, and each sees
/// what the ones before wrote.
pub fn dispatches_share_a_pass(engine: &mut Engine) {
    const ADD: &str = "
var<storage, read> src: array<u32>;
var<storage, read_write> out: array<u32>;
@compute @workgroup_size(1) fn main() { out[0] = src[0] + 1u; }";
    for timed in [false, true] {
        let mut plan = new_plan();
        let ids: Vec<_> = (0..=20).map(|i| plan.buffer(&format!("b{i}"), 1)).collect();
        for (nth, pair) in ids.windows(2).enumerate() {
            if nth == 10 {
                plan.pass("copy", PassKind::Copy { from: plan.whole(pair[0]), to: plan.whole(pair[1]) });
                continue;
            }
            let bound = [("src", read_only(pair[0])), ("out", storage(pair[1]))];
            plan.compute(&format!("add{nth}"), ADD, &bound, Dispatch::Groups([1, 1, 1]));
        }
        let mut runner = prepare(engine, plan);
        runner.time_passes(timed);
        let report = run(engine, &mut runner);
        assert_eq!((report.compute_passes, report.render_passes, report.submissions), (2, 0, 1));
        assert_eq!(words(engine, &runner, ids[20]), [19]);
        assert!(report.passes.iter().all(|p| p.gpu_ms.is_some() == timed && p.timed_with.is_none()), "{report:?}");
        assert!(report.submit_ms > 0.0 && report.encode_ms > 0.0);
    }
}

/// A device that tells no time inside of passes gives those that share one a time together.
pub fn shared_passes_have_one_time(_: &mut Engine) {
    const ADD: &str = "
var<storage, read_write> out: array<u32>;
@compute @workgroup_size(1) fn main() { out[0] += 1u; }";
    let options = GpuOptions { without: wgpu_types::Features::TIMESTAMP_QUERY_INSIDE_PASSES, ..GpuOptions::default() };
    let engine = &mut Engine::new(Gpu::open(&options).unwrap());
    let mut plan = new_plan();
    let (a, b) = (plan.buffer("a", 1), plan.buffer("b", 1));
    for (name, id) in [("first", a), ("second", b), ("third", a)] {
        plan.compute(name, ADD, &[("out", storage(id))], Dispatch::Groups([1, 1, 1]));
    }
    let mut runner = prepare(engine, plan);
    let report = run(engine, &mut runner);
    let with: Vec<_> = report.passes.iter().map(|p| (p.gpu_ms.is_some(), p.timed_with.as_deref())).collect();
    assert_eq!(with, [(true, None), (false, Some("first")), (false, Some("first"))]);
    assert!(report.gpu_ms().is_some(), "the shared time counts once, and nothing lacks one");
}
