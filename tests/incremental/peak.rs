//! The smallest policy: what the engine holds at once is what the plan says, little more than what is
//! live at once, and the picture is that of the keeping policy.

use meniscus::engine::{Engine, Frame, Policy, StepInfo};
use meniscus::graph::value::Value;
use meniscus::plan::model::{InputInfo, Plan};

use crate::planning::Test;
use crate::shipped::{Shipped, alike, reached_by_order};

/// Of the largest live set, what the frame may hold at once.
const MOST: f64 = 1.3;

/// The outputs after a frame: bytes, and texels of those that the order of atomics reaches.
struct Outputs {
    ordered: Vec<Vec<u8>>,
    others: Vec<Vec<[f32; 4]>>,
}

/// What comes out of a frame under a policy, and the most that was held in it.
fn frame(shipped: &mut Shipped<'_>, policy: Policy) -> (Outputs, u64) {
    shipped.policy = policy;
    shipped.start_anew();
    let report = shipped.try_run(false).unwrap_or_else(|d| panic!("{policy:?}: {d:#?}"));
    let runner = shipped.skips();
    let plan = runner.plan();
    assert!(report.submissions as usize > plan.memory.cuts(policy).len(), "{policy:?}: each cut hands over");
    let outputs = plan.outputs.iter().map(|output| output.object);
    let (others, ordered): (Vec<_>, Vec<_>) = outputs.partition(|o| reached_by_order(plan, shipped.engine, *o));
    let peak = runner.peak_bytes();
    (Outputs { ordered: shipped.read(&ordered), others: shipped.texels(&others) }, peak)
}

pub fn holds_what_its_plan_says(engine: &mut Engine, name: &str) {
    for viewport in [[640, 480], [333, 517]] {
        let mut shipped = Shipped::alone(engine, name, |_| ());
        shipped.request.viewport = viewport;
        let (kept, _) = frame(&mut shipped, Policy::Keep);
        let (pictures, peak) = frame(&mut shipped, Policy::Smallest);
        assert!(pictures.ordered == kept.ordered, "{name}: the policies draw other pictures at {viewport:?}");
        for (a, b) in pictures.others.iter().zip(&kept.others) {
            alike(a, b).unwrap_or_else(|what| panic!("{name} at {viewport:?}: what one policy draws {what}"));
        }
        assert!(!kept.ordered.is_empty() || !kept.others.is_empty(), "{name} has outputs");
        let memory = shipped.skips().plan().memory.clone();
        assert_eq!(peak, memory.held(Policy::Smallest), "{name}: the plan says what is held at {viewport:?}");
        let ratio = memory.of_frame(Policy::Smallest) as f64 / memory.lower_bound as f64;
        println!("{name} at {viewport:?}: {ratio:.2} of what is live at once, {} cuts", memory.cuts.len());
        assert!(ratio <= MOST, "{name}: {ratio} of what is live at once at {viewport:?}");
        // Again, from what the frame before left.
        shipped.orbit(0.2);
        shipped.try_run(false).unwrap();
        assert_eq!(shipped.skips().peak_bytes(), peak, "{name}: the next frame holds as much");
    }
}

/// A shipped graph whose frame is cut.
fn cut(engine: &mut Engine, alter: fn(&mut Plan)) -> Shipped<'_> {
    let mut shipped = Shipped::alone(engine, "iwasaki2006.ron", alter);
    shipped.request.viewport = [320, 240];
    shipped.policy = Policy::Smallest;
    assert!(!shipped.plan().memory.cuts.is_empty(), "the frame is cut");
    shipped
}

pub fn a_cut_that_is_left_out_is_caught(engine: &mut Engine) {
    // What it gives back stays, and what it makes is there from the start.
    let left_out: fn(&mut Plan) = |plan| _ = plan.memory.cuts.drain(..1.min(plan.memory.cuts.len()));
    let keeps: fn(&mut Plan) = |plan| plan.memory.cuts.iter_mut().for_each(|cut| cut.gives.clear());
    for fault in [left_out, keeps] {
        let mut shipped = cut(engine, fault);
        let held = shipped.plan().memory.held(Policy::Smallest);
        let (_, peak) = frame(&mut shipped, Policy::Smallest);
        assert!(peak > held, "{peak} is held, and {held} as planned");
    }
}

pub fn memory_that_is_given_back_too_early_is_caught(engine: &mut Engine) {
    let mut shipped = cut(engine, |plan| {
        let last = |slot: &usize| {
            let ids = plan.memory.smallest[*slot].objects.iter();
            ids.filter_map(|id| Some(plan.objects[*id].lifetime?.1)).max()
        };
        if let Some(at) = plan.memory.cuts.first().and_then(|cut| cut.gives.iter().filter_map(last).max()) {
            plan.memory.cuts[0].before = at;
        }
    });
    shipped.start_anew();
    let refused = shipped.try_run(false).err();
    let said = refused.iter().flat_map(|found| found.iter()).map(|d| d.message.clone()).collect::<String>();
    assert!(said.contains("what is bound to"), "{said}");
}

/// Two textures of other descriptions, one after the other.
fn parted() -> Plan {
    let graph = r#"Graph(
        inputs: { "camera": Camera },
        resources: { "a": Texture(format: Rgba32Float, size: (64, 64)), "b": Texture(format: Rgba16Float, size: (8, 8)),
                     "c": Texture(format: Rgba32Float, size: (60, 64)), "out": Texture(format: Rgba16Float, size: (8, 8)) },
        passes: [
            Fullscreen(name: "a", shader: "paint.wgsl", color: ["a"]),
            Fullscreen(name: "b", shader: "filter.wgsl", color: ["b"], bind: {"src": "a"}),
            Fullscreen(name: "c", shader: "filter.wgsl", color: ["c"], bind: {"src": "b"}),
            Fullscreen(name: "out", shader: "filter.wgsl", color: ["out"], bind: {"src": "c"}),
        ],
        outputs: ["out"],
    )"#;
    Test::new(graph).input("camera", InputInfo::Camera).plan()
}

pub fn commands_of_others_are_not_cut(engine: &mut Engine) {
    let mut plan = parted();
    plan.memory.policy = Policy::Smallest;
    assert_eq!(plan.memory.cuts.len(), 1);
    let (held, all) = (plan.memory.held(Policy::Smallest), plan.memory.smallest.iter().map(|slot| slot.bytes).sum());
    assert!(held < all);
    let out = plan.outputs[0].object;
    let mut runner = engine.prepare(plan, None).unwrap_or_else(|refused| panic!("{:#?}", refused.diagnostics));
    runner.run_all(true);
    let live = |_: &str, _: Option<&StepInfo>| Some(Value::vec([1.0, 0.0, 0.0]));
    let frame = Frame { time: 1.0, delta: 0.1, frame: 0, steps: &[], live: &live, only: None };
    let mut pictures = Vec::new();
    for into_others in [false, true, false] {
        if into_others {
            let mut encoder = engine.gpu().device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            runner.encode(engine, &frame, &mut encoder).unwrap();
            engine.gpu().queue().submit([encoder.finish()]);
        } else {
            runner.run(engine, &frame).unwrap();
        }
        runner.finish(engine).unwrap();
        assert_eq!(runner.peak_bytes(), if into_others { all } else { held });
        pictures.push(runner.read_texture(engine, out, 0, None).unwrap().bytes);
    }
    assert!(pictures.iter().all(|picture| *picture == pictures[0] && picture.iter().any(|byte| *byte != 0)));
}
