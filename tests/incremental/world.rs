//! Two runners of one graph: one that skips, one that runs everything on the least memory.

use meniscus::diagnostic::{Style, render_all};
use meniscus::engine::{Engine, Frame, Policy, Report, Runner, StepInfo};
use meniscus::graph::value::Value;
use meniscus::plan::model::{ObjectId, ObjectKind, ObjectRef, Origin, Plan, Request};

use crate::generate::{GIVEN, Generated, PICTURE};
use crate::planning::objects;

/// What frames and planners are told.
#[derive(Clone, Debug)]
pub struct Now {
    pub time: f64,
    pub eye: [f64; 3],
    pub viewport: [u32; 2],
    pub steps: u32,
    pub picture: u8,
    pub given: u32,
}

/// Changes a plan before it is prepared.
pub type Alter = fn(&mut Plan);

pub struct World<'e> {
    pub engine: &'e mut Engine,
    pub graph: Generated,
    pub now: Now,
    /// How the plan of the skipping runner is altered.
    pub alter: Alter,
    pub policy: Policy,
    skips: Option<Runner>,
    full: Option<Runner>,
}

/// Numbers from a seed, the same on every machine (splitmix64).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 16) as u32
    }

    pub fn below(&mut self, n: u32) -> u32 {
        self.next() % n
    }
}

impl<'e> World<'e> {
    pub fn new(engine: &'e mut Engine, graph: Generated, alter: Alter) -> Self {
        let now = Now { time: 1.0, eye: [0.25; 3], viewport: [24, 18], steps: 1, picture: 7, given: 3 };
        let mut world = Self { engine, graph, now, alter, policy: Policy::Keep, skips: None, full: None };
        world.prepare();
        world.upload();
        world
    }

    pub fn skips(&mut self) -> &mut Runner {
        self.skips.as_mut().unwrap()
    }

    pub fn full(&self) -> &Runner {
        self.full.as_ref().unwrap()
    }

    fn plan(&self) -> Plan {
        let gpu = self.engine.gpu();
        let asked = self.graph.request(gpu.features(), gpu.limits(), false);
        let request = Request { viewport: self.now.viewport, ..asked };
        self.graph.plan(&request).unwrap_or_else(|(found, sources)| {
            panic!("{}\n{}", self.graph.graph, render_all(&found, &sources, Style::Plain));
        })
    }

    /// Plans anew and swaps both runners.
    pub fn prepare(&mut self) {
        let mut plan = self.plan();
        let mut altered = plan.clone();
        (self.alter)(&mut altered);
        altered.memory.policy = self.policy;
        plan.memory.policy = Policy::Share;
        self.skips = Some(prepare(self.engine, altered, self.skips.take()));
        let mut full = prepare(self.engine, plan, self.full.take());
        full.run_all(true);
        self.full = Some(full);
    }

    /// Hands both runners what comes from outside.
    pub fn upload(&mut self) {
        self.upload_picture();
        self.upload_given();
    }

    pub fn upload_picture(&mut self) {
        let texels: Vec<u8> = (0..PICTURE * PICTURE * 4).map(|i| self.now.picture.wrapping_add(i as u8)).collect();
        self.each(&|engine, runner| {
            if let Some(id) = input(runner.plan(), "picture") {
                runner.upload_texture(engine, id, 0, 0, &texels).unwrap();
            }
        });
    }

    pub fn upload_given(&mut self) {
        let bytes: Vec<u8> = (0..GIVEN).flat_map(|i| (self.now.given + i).to_le_bytes()).collect();
        self.each(&|engine, runner| {
            if let Some(id) = input(runner.plan(), "given") {
                runner.upload_buffer(engine, id, &bytes).unwrap();
            }
        });
    }

    /// Does the same with both runners.
    pub fn each(&mut self, what: &dyn Fn(&mut Engine, &mut Runner)) {
        for runner in [&mut self.skips, &mut self.full].into_iter().flatten() {
            what(self.engine, runner);
        }
    }

    /// A frame of the skipping runner alone, of some of its passes.
    pub fn run_only(&mut self, only: &[bool]) {
        let now = Now { steps: 0, ..self.now.clone() };
        run(self.engine, self.skips.as_mut().unwrap(), &now, Some(only));
    }

    /// A frame that cannot be finished, since the camera has no place.
    pub fn fail(&mut self) {
        let live = |_: &str, _: Option<&StepInfo>| None;
        let frame = Frame { time: 99.0, delta: 0.1, frame: 0, steps: &[], live: &live, only: None };
        // A graph that does not look at the camera runs.
        _ = self.skips.as_mut().unwrap().run(self.engine, &frame);
        _ = self.engine.gpu().check();
    }

    /// A frame of both; gives the report of the one that skips, and of the other.
    pub fn frame(&mut self) -> [Report; 2] {
        let now = self.now.clone();
        [&mut self.skips, &mut self.full].map(|runner| run(self.engine, runner.as_mut().unwrap(), &now, None))
    }

    /// What differs between both runners, of all that somebody may look at and the order of
    /// atomics does not reach.
    pub fn differences(&mut self) -> Vec<String> {
        let (skips, full) = (self.skips.as_ref().unwrap(), self.full.as_ref().unwrap());
        let plan = full.plan();
        let unordered: Vec<ObjectId> = (plan.passes.iter().filter(|p| p.unordered))
            .flat_map(|p| p.accesses.iter().filter(|a| a.write).flat_map(|a| objects(plan, a.object)))
            .collect();
        let mut asked: Vec<(&str, ObjectRef)> = plan.outputs.iter().map(|o| (o.name.as_str(), o.object)).collect();
        asked.extend(self.graph.roots.iter().filter_map(|root| Some((root.as_str(), *plan.names.get(root)?))));
        let mut differ = Vec::new();
        for (name, object) in asked {
            if objects(plan, object).iter().any(|id| unordered.contains(id)) {
                continue;
            }
            let [a, b] = [skips, full].map(|runner| read(self.engine, runner, object));
            if a != b {
                let first = a.iter().zip(&b).position(|(a, b)| a != b);
                differ.push(format!("{name} from byte {first:?} of {}", a.len()));
            }
        }
        differ
    }
}

fn prepare(engine: &mut Engine, plan: Plan, before: Option<Runner>) -> Runner {
    engine.prepare(plan, before).unwrap_or_else(|refused| panic!("{:#?}", refused.diagnostics))
}

fn run(engine: &Engine, runner: &mut Runner, now: &Now, only: Option<&[bool]>) -> Report {
    let live = |name: &str, _: Option<&StepInfo>| (name == "camera.position").then(|| Value::vec(now.eye));
    let steps = [now.steps];
    let frame = Frame { time: now.time, delta: 0.25, frame: 0, steps: &steps, live: &live, only };
    runner.run(engine, &frame).unwrap_or_else(|d| panic!("{d:#?}"));
    runner.finish(engine).unwrap_or_else(|d| panic!("{d:#?}"))
}

fn input(plan: &Plan, name: &str) -> Option<ObjectId> {
    plan.objects.iter().position(|o| o.origin == Origin::Input(name.into()))
}

/// The bytes of an object, of all mips of a texture; none of what cannot be read.
pub fn read(engine: &mut Engine, runner: &Runner, object: ObjectRef) -> Vec<u8> {
    let id = objects(runner.plan(), object)[0];
    match &runner.plan().objects[id].kind {
        ObjectKind::Buffer(buffer) => {
            let bytes = runner.read_buffer(engine, object).unwrap();
            // What is behind the count of a counted buffer is nobody's.
            let count = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
            let length = if buffer.counted { 4 + count.min(buffer.items as usize) * 4 } else { bytes.len() };
            bytes[..length].to_vec()
        }
        ObjectKind::Texture(t) if t.samples == 1 && !t.format.has_stencil_aspect() => {
            (0..t.mips).flat_map(|mip| runner.read_texture(engine, object, mip, None).unwrap().bytes).collect()
        }
        ObjectKind::Texture(_) => Vec::new(),
    }
}
