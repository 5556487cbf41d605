//! Every shipped graph, on a small picture: what runs when the camera orbits, when a parameter is
//! turned, and when anything changes.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use meniscus::check;
use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::engine::{Engine, Frame, Policy, Report, Runner, StepInfo};
use meniscus::files::{DiskFiles, Files};
use meniscus::graph::model::ParamKind;
use meniscus::graph::value::Value;
use meniscus::host::params::declared;
use meniscus::plan::changes::Reason;
use meniscus::plan::instantiate_stand_in;
use meniscus::plan::model::{Causes, InputInfo, ObjectId, ObjectRef, Origin, Param, Plan, Request};
use meniscus::program::{self, Program};
use meniscus::scene::{Camera, Light};

use crate::golden::golden;
use crate::peak;
use crate::planning::objects;
use crate::poison;
use crate::world::{Numbers, read};

const VIEWPORT: [u32; 2] = [40, 30];
/// `MENISCUS_STEPS=200` in the environment looks further.
const STEPS: u32 = 12;
/// Bytes that a graph may come to hold by turning its parameters: several times what each has as it is declared.
const LARGEST: u64 = 256 << 20;

/// Words in graphs and shaders that somebody may write in place of others, where a file has them.
const EDITS: [(&str, &str); 4] =
    [("vertices: 4", "vertices: 3"), (" * 0.5", " * 0.45"), (" 0.25", " 0.2"), (" + 1.0", " + 1.0625")];

/// Where the order of atomics reaches and the device has many threads, two full runs of a frame differ too: a sum of
/// floats falls to the other side of a level, and a piece of a surface is there or not. So much of the mean value, on the
/// mean, and so large a share of texels by more than a tenth of it.
const MEAN_APART: f64 = 0.15;
const SHARE_APART: f64 = 0.2;

/// The shipped files, some with other words in them.
#[derive(Default)]
struct Edited {
    /// Files with what was written into them.
    edits: BTreeSet<(PathBuf, usize)>,
}

impl Files for Edited {
    fn read(&self, path: &Path) -> std::io::Result<Arc<[u8]>> {
        let mut bytes = DiskFiles.read(path)?;
        for (_, edit) in self.edits.iter().filter(|(file, _)| file == path) {
            let (from, to) = EDITS[*edit];
            bytes = String::from_utf8_lossy(&bytes).replacen(from, to, 1).into_bytes().into();
        }
        Ok(bytes)
    }

    fn exists(&self, path: &Path) -> bool {
        DiskFiles.exists(path)
    }
}

pub struct Shipped<'e> {
    pub engine: &'e mut Engine,
    name: String,
    program: Program,
    sources: Sources,
    files: Edited,
    /// Where an edit finds its word: a file, and the number of the edit.
    editable: Vec<(PathBuf, usize)>,
    pub request: Request,
    camera: Camera,
    time: f64,
    steps: u32,
    /// Turns where particles are.
    seed: u64,
    pub alter: fn(&mut Plan),
    pub policy: Policy,
    skips: Option<Runner>,
    /// Runs everything, to compare with, where a test compares.
    full: Option<Runner>,
    /// How many outputs were compared.
    looked_at: usize,
}

/// A shipped graph with all that was read.
fn loaded(files: &Edited, name: &str) -> (Program, Sources, Vec<PathBuf>) {
    let mut sources = Sources::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("graphs").join(name);
    let loaded = program::load(files, &mut sources, path.to_str().unwrap(), None);
    let said = render_all(&loaded.diagnostics, &sources, Style::Plain);
    (loaded.program.unwrap_or_else(|| panic!("{name}: {said}")), sources, loaded.read)
}

/// Names of the shipped graphs, without parts.
fn graphs() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("graphs");
    let names = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".ron")).collect();
    names.sort();
    assert!(names.len() >= 2, "the shipped graphs are not where they should be");
    names
}

impl<'e> Shipped<'e> {
    fn new(engine: &'e mut Engine, name: &str, alter: fn(&mut Plan)) -> Self {
        let mut shipped = Self::alone(engine, name, alter);
        shipped.prepare_full();
        shipped.upload();
        shipped
    }

    /// Without the runner that runs everything.
    pub fn alone(engine: &'e mut Engine, name: &str, alter: fn(&mut Plan)) -> Self {
        let files = Edited::default();
        let (program, sources, read) = loaded(&files, name);
        let has =
            |path: &Path, edit: usize| String::from_utf8_lossy(&files.read(path).unwrap()).contains(EDITS[edit].0);
        let all = read.into_iter().flat_map(|path| (0..EDITS.len()).map(move |edit| (path.clone(), edit)));
        let editable = all.filter(|(path, edit)| path.is_file() && has(path, *edit)).collect();
        let mut request = check::stand_in(&program);
        (request.features, request.limits) = (engine.gpu().features(), engine.gpu().limits());
        request.viewport = VIEWPORT;
        let camera = Camera::new(DVec3::new(1.2, 1.0, 1.2), DVec3::new(0.0, 0.4, 0.0), 45.0);
        let mut shipped = Self {
            engine,
            name: name.to_owned(),
            program,
            sources,
            files,
            editable,
            request,
            camera,
            time: 0.0,
            steps: 0,
            seed: 1,
            alter,
            policy: Policy::Keep,
            skips: None,
            full: None,
            looked_at: 0,
        };
        shipped.prepare();
        shipped.upload();
        shipped
    }

    pub fn plan(&self) -> Plan {
        instantiate_stand_in(&self.program, &self.request)
            .unwrap_or_else(|d| panic!("{}: {}", self.name, render_all(&d, &self.sources, Style::Plain)))
    }

    fn prepare(&mut self) {
        let mut plan = self.plan();
        (self.alter)(&mut plan);
        let before = self.skips.take();
        plan.memory.policy = self.policy;
        let prepared = self.engine.prepare(plan, before);
        self.skips = Some(prepared.unwrap_or_else(|refused| panic!("{}: {:#?}", self.name, refused.diagnostics)));
        if self.full.is_some() {
            self.prepare_full();
        }
    }

    /// Nothing goes over from the runner before.
    pub fn start_anew(&mut self) {
        self.skips = None;
        self.prepare();
        self.upload();
    }

    fn prepare_full(&mut self) {
        let (mut plan, before) = (self.plan(), self.full.take());
        plan.memory.policy = Policy::Keep;
        let prepared = self.engine.prepare(plan, before);
        self.full = Some(prepared.unwrap_or_else(|refused| panic!("{}: {:#?}", self.name, refused.diagnostics)));
        self.full.as_mut().unwrap().run_all(true);
    }

    /// Somebody writes a word into a file, or takes it back.
    fn edit(&mut self, numbers: &mut Numbers) -> String {
        let edit = self.editable[numbers.below(self.editable.len() as u32) as usize].clone();
        let said = format!("{:?} in {}", EDITS[edit.1], edit.0.display());
        if !self.files.edits.remove(&edit) {
            self.files.edits.insert(edit);
        }
        (self.program, self.sources, _) = loaded(&self.files, &self.name);
        self.prepare();
        said
    }

    /// Particles in the bounds that the plan was told of, where they belong; the rest is zero.
    fn upload(&mut self) {
        for runner in [&mut self.skips, &mut self.full].into_iter().flatten() {
            for id in 0..runner.plan().objects.len() {
                let Some(bytes) = positions(runner.plan(), id, &self.request, self.seed) else { continue };
                runner.upload_buffer(self.engine, id, &bytes).unwrap();
            }
        }
    }

    pub fn skips(&self) -> &Runner {
        self.skips.as_ref().unwrap()
    }

    pub fn read(&mut self, objects: &[ObjectRef]) -> Vec<Vec<u8>> {
        let runner = self.skips.as_ref().unwrap();
        objects.iter().map(|object| read(self.engine, runner, *object)).collect()
    }

    pub fn texels(&mut self, objects: &[ObjectRef]) -> Vec<Vec<[f32; 4]>> {
        let runner = self.skips.as_ref().unwrap();
        objects.iter().map(|object| texels(self.engine, runner, *object)).collect()
    }

    /// The paths of each unit's passes.
    fn passes_of_units(&self) -> Vec<Vec<String>> {
        let plan = self.skips().plan();
        plan.units.iter().map(|unit| unit.passes.iter().map(|p| plan.passes[*p].path.clone()).collect()).collect()
    }

    /// What makes the state of each `Steps` start anew when it changes.
    fn keys(&self) -> Vec<u128> {
        self.skips().plan().steps.iter().map(|steps| steps.key).collect()
    }

    /// What somebody may turn: not what a `Use` gives.
    fn params(&self) -> Vec<Param> {
        let declared = declared(&self.program);
        self.skips().plan().params.iter().filter(|p| declared.contains_key(&p.path)).cloned().collect()
    }

    fn run(&mut self, all: bool) -> Report {
        self.try_run(all).unwrap_or_else(|d| panic!("{}: {d:#?}", self.name))
    }

    pub fn try_run(&mut self, all: bool) -> Result<Report, Diagnostics> {
        let runner = if all { self.full.as_mut() } else { self.skips.as_mut() }.unwrap();
        let (camera, viewport) = (self.camera, self.request.viewport);
        let live = |name: &str, _: Option<&StepInfo>| live(name, &camera, viewport);
        let steps = vec![self.steps; runner.plan().steps.len()];
        let frame = Frame { time: self.time, delta: 1.0 / 60.0, frame: 0, steps: &steps, live: &live, only: None };
        runner.run(self.engine, &frame)?;
        Ok(runner.finish(self.engine)?)
    }

    /// The units that run in the next frame of the runner that skips.
    fn ran(&mut self) -> BTreeSet<usize> {
        let report = self.run(false);
        (0..report.units.len()).filter(|u| report.units[*u].ran).collect()
    }

    /// The units outside of steps whose causes fit.
    fn with(&self, fits: impl Fn(&Causes) -> bool) -> BTreeSet<usize> {
        let plan = self.skips().plan();
        let outside = |u: &usize| plan.units[*u].passes.iter().any(|p| plan.passes[*p].steps.is_none());
        (0..plan.units.len()).filter(|u| outside(u) && fits(&plan.units[*u].causes)).collect()
    }

    pub fn orbit(&mut self, turn: f64) {
        let turned = glam::DQuat::from_rotation_y(turn) * (self.camera.eye - self.camera.target);
        self.camera.eye = self.camera.target + turned;
    }

    /// Holds every output of the runner that skips against that of the one that runs all.
    fn same(&mut self) -> Result<(), String> {
        let plan = self.full.as_ref().unwrap().plan();
        let reached = |object| reached_by_order(plan, self.engine, object);
        let outputs: Vec<_> = plan.outputs.iter().map(|o| (o.name.clone(), o.object, reached(o.object))).collect();
        assert!(!outputs.is_empty());
        for (name, object, is_reached) in outputs {
            self.looked_at += 1;
            let both = [self.skips.as_ref().unwrap(), self.full.as_ref().unwrap()];
            if is_reached {
                let [a, b] = both.map(|runner| texels(self.engine, runner, object));
                alike(&a, &b).map_err(|what| format!("`{name}` {what}"))?;
                continue;
            }
            let [a, b] = both.map(|runner| read(self.engine, runner, object));
            let differ = a.iter().zip(&b).filter(|(a, b)| a != b).count();
            if a != b {
                return Err(format!("`{name}` differs in {differ} of {} bytes", a.len()));
            }
        }
        Ok(())
    }
}

/// Whether the order of atomics reaches a resource: never on the software driver, which has one thread here and so takes
/// them in one order.
pub fn reached_by_order(plan: &Plan, engine: &Engine, object: ObjectRef) -> bool {
    let mut written = plan.passes.iter().filter(|p| p.unordered).flat_map(|p| p.accesses.iter().filter(|a| a.write));
    let own = objects(plan, object);
    !is_software(engine) && written.any(|access| objects(plan, access.object).iter().any(|id| own.contains(id)))
}

fn is_software(engine: &Engine) -> bool {
    engine.gpu().info().name.contains("llvmpipe")
}

fn texels(engine: &mut Engine, runner: &Runner, texture: ObjectRef) -> Vec<[f32; 4]> {
    runner.read_texture(engine, texture, 0, None).unwrap().to_rgba_f32()
}

/// # Errors
/// If two pictures differ by more than the order of atomics explains.
pub fn alike(a: &[[f32; 4]], b: &[[f32; 4]]) -> Result<(), String> {
    let (mean, share) = apart(a, b);
    let is_alike = mean <= MEAN_APART && share <= SHARE_APART;
    if is_alike { Ok(()) } else { Err(format!("differs by {mean}, and in {share} of its texels")) }
}

/// By how much two pictures differ: the mean difference, of the mean value, and the share of texels that differ by more
/// than a tenth of it.
fn apart(a: &[[f32; 4]], b: &[[f32; 4]]) -> (f64, f64) {
    assert!(a.len() == b.len() && !a.is_empty());
    let value = |x: f32| if x.is_finite() { f64::from(x) } else { 1e4 };
    let mean = b.iter().flatten().map(|x| value(*x).abs()).sum::<f64>() / (4 * b.len()) as f64;
    let most = |(a, b): (&[f32; 4], &[f32; 4])| {
        a.iter().zip(b).map(|(a, b)| (value(*a) - value(*b)).abs()).fold(0.0, f64::max)
    };
    let all: Vec<f64> = a.iter().zip(b).map(most).collect();
    let far = all.iter().filter(|apart| **apart > mean / 10.0).count();
    (all.iter().sum::<f64>() / all.len() as f64 / mean.max(1e-6), far as f64 / all.len() as f64)
}

/// The values of cameras and lights by the names of their fields; whatever else is live stands still.
fn live(name: &str, camera: &Camera, viewport: [u32; 2]) -> Option<Value> {
    let field = name.split_once('.')?.1;
    let sun = Light { direction: DVec3::new(-0.45, -0.75, -0.5), color: DVec3::ONE, intensity: 4.0 };
    match field {
        "direction" | "color" | "intensity" => sun.field(field),
        "origin" => Some(Value::vec([0.0; 3])),
        "pressed" => Some(Value::Int(0)),
        _ => camera.field(field, viewport),
    }
}

fn positions(plan: &Plan, id: ObjectId, request: &Request, seed: u64) -> Option<Vec<u8>> {
    let Origin::Attribute { input, attribute, .. } = &plan.objects[id].origin else { return None };
    let InputInfo::Particles { count, min, max, .. } = request.inputs.get(input)? else { return None };
    if attribute != "position" {
        return None;
    }
    let mut numbers = Numbers(seed);
    let mut bytes = Vec::new();
    for _ in 0..*count {
        for axis in 0..3 {
            let part = f64::from(numbers.below(1000)) / 1000.0;
            bytes.extend(((min[axis] + part * (max[axis] - min[axis])) as f32).to_le_bytes());
        }
    }
    Some(bytes)
}

/// Another value that the parameter may have.
fn other(param: &Param, numbers: &mut Numbers) -> Option<Value> {
    let number = |v: &Option<Value>| v.as_ref().and_then(|v| v.components().next()?.as_f64());
    let (min, max) = (number(&param.min), number(&param.max));
    let part = f64::from(1 + numbers.below(6)) / 8.0;
    let between = |now: f64| match (min, max) {
        // Not too far: loops may be long.
        (Some(min), Some(max)) => min + (max.min(min + 12.0) - min) * part,
        _ => now * (0.5 + part) + 0.01,
    };
    let value = match (&param.kind, &param.value) {
        (ParamKind::Bool, Value::Bool(now)) => Value::Bool(!now),
        (ParamKind::Int, Value::Int(now)) => Value::Int(between(*now as f64).round() as i64),
        (ParamKind::Float, now) => Value::Float(between(now.as_f64()?)),
        (ParamKind::Choice(words), Value::Word(now)) => {
            Value::Word(words.iter().map(|w| &w.value).find(|word| *word != now)?.clone())
        }
        (_, Value::Vector(now)) => {
            let is_in = |x: &f64| min.is_none_or(|min| *x >= min) && max.is_none_or(|max| *x <= max);
            let turned = |x: f64| [x * 0.75 + 0.05, x * 1.5].into_iter().find(is_in).unwrap_or(x);
            Value::vec(now.iter().filter_map(|x| x.as_f64()).map(turned))
        }
        _ => return None,
    };
    (value != param.value).then_some(value)
}

fn orbiting(engine: &mut Engine, name: &str) {
    let mut shipped = Shipped::new(engine, name, |_| ());
    let all = shipped.skips().plan().units.len();
    let first = shipped.ran();
    assert_eq!(first, shipped.with(|_| true), "{name}: at first all run");
    assert!(shipped.ran().is_empty(), "{name}: a still picture runs nothing");
    let report = shipped.run(false);
    assert!(report.passes.is_empty() && report.submissions == 0 && report.complete, "{name}: {report:#?}");
    shipped.orbit(0.1);
    let expected = shipped.with(|causes| causes.live.iter().any(|live| sees_camera(live)));
    assert!(expected.len() < all, "{name}: something does not see the camera");
    assert_eq!(shipped.ran(), expected, "{name}: which of {all} units run as the camera orbits");
    shipped.run(true);
    shipped.same().unwrap_or_else(|what| panic!("{name}: {what} after orbiting"));
    shipped.seed += 1;
    shipped.upload();
    let expected = shipped.with(|causes| causes.inputs.contains("particles"));
    assert_eq!(shipped.ran(), expected, "{name}: which run as the particles move");
}

fn sees_camera(live: &str) -> bool {
    live == "camera.position" || live.contains("_from_")
}

/// Units that do not know that they see the camera keep what they made for another one.
fn forgotten_camera(engine: &mut Engine, name: &str) {
    let mut shipped = Shipped::new(engine, name, |plan| {
        plan.units.iter_mut().for_each(|unit| unit.causes.live.retain(|live| !live.starts_with("camera.")));
    });
    for turn in [0.0, 1.0] {
        shipped.orbit(turn);
        shipped.run(false);
        shipped.run(true);
        let same = shipped.same();
        assert_eq!(same.is_ok(), turn == 0.0, "{name} after a turn by {turn}: {same:?}");
    }
}

/// Turns one half of the parameters after the other: of some graphs all take minutes.
fn parameters(engine: &mut Engine, name: &str, half: usize) {
    let mut shipped = Shipped::alone(engine, name, |_| ());
    let all = shipped.params();
    let params = &all[half * all.len() / 2..(half + 1) * all.len() / 2];
    let first = shipped.run(false).passes.len();
    shipped.orbit(0.1);
    let mut ran_for = format!("first: {first} passes\ncamera: {}\n", shipped.run(false).passes.len());
    let mut turned = 0;
    for param in params {
        let Some(value) = other(param, &mut Numbers(7)) else {
            _ = writeln!(ran_for, "{}: has no other value here", param.path);
            continue;
        };
        _ = write!(ran_for, "{} = {value}:", param.path);
        for params in [BTreeMap::from([(param.path.clone(), value)]), BTreeMap::new()] {
            shipped.request.params = params;
            let (before, keys) = (shipped.passes_of_units(), shipped.keys());
            shipped.prepare();
            let expected = shipped.with(|causes| causes.params.contains(&param.path));
            let report = shipped.run(false);
            _ = write!(ran_for, " {} of {}", report.passes.len(), report.passes_planned);
            let mut ran: BTreeSet<usize> = (0..report.units.len()).filter(|u| report.units[*u].ran).collect();
            let after = shipped.passes_of_units();
            if after.iter().collect::<BTreeSet<_>>() != before.iter().collect() {
                // A branch was taken or left. Units of other passes run first, and resources share
                // memory otherwise: what lost its memory is made again.
                let moved = [Reason::Memory, Reason::Shared, Reason::Upstream];
                let is_due = |u: &usize, why: &Reason| match why {
                    Reason::First => !before.contains(&after[*u]),
                    _ => moved.contains(why),
                };
                ran.retain(|u| expected.contains(u) || !report.units[*u].why.iter().all(|why| is_due(u, why)));
            }
            if shipped.keys() != keys {
                // State starts anew, and what reads it is made anew.
                let restarted = [Reason::Memory, Reason::Reset, Reason::Upstream];
                ran.retain(|u| expected.contains(u) || !report.units[*u].why.iter().all(|w| restarted.contains(w)));
            }
            let why: Vec<_> = ran.difference(&expected).map(|u| (&after[*u], &report.units[*u].why)).collect();
            let of = (&param.path, &shipped.request.params);
            assert_eq!(ran, expected, "{name}: which run for {of:?}; besides: {why:#?}");
            assert!(shipped.ran().is_empty(), "{name}: `{}` is done with", param.path);
        }
        turned += 1;
        ran_for.push('\n');
    }
    // Devices that can do other things have other plans.
    if is_software(shipped.engine) {
        golden(format!("tests/incremental/ran/{}_{half}.txt", name.trim_end_matches(".ron")), &ran_for);
    }
    assert!(turned * 3 >= params.len() * 2, "{name}: {turned} of {} parameters could be turned", params.len());
}

fn another(policy: Policy, numbers: &mut Numbers) -> Policy {
    let others: Vec<Policy> = Policy::ALL.into_iter().filter(|other| *other != policy).collect();
    others[numbers.below(others.len() as u32) as usize]
}

fn change(shipped: &mut Shipped<'_>, numbers: &mut Numbers) -> String {
    shipped.steps = 0;
    match numbers.below(10) {
        0 => {
            shipped.orbit(0.3);
            "orbiting".into()
        }
        1 => {
            shipped.seed += 1;
            shipped.upload();
            "moving particles".into()
        }
        2 => {
            shipped.request.viewport = [1 + numbers.below(60), 1 + numbers.below(60)];
            shipped.prepare();
            format!("resizing to {:?}", shipped.request.viewport)
        }
        3 => {
            shipped.prepare();
            "preparing again".into()
        }
        4 => {
            shipped.time += 0.25;
            shipped.steps = 1 + numbers.below(2);
            "time and steps".into()
        }
        5 => {
            shipped.policy = another(shipped.policy, numbers);
            shipped.prepare();
            format!("the policy {:?}", shipped.policy)
        }
        6 => {
            shipped.request.params.clear();
            shipped.prepare();
            "all parameters as declared".into()
        }
        7 => shipped.edit(numbers),
        _ => {
            let params = shipped.params();
            let Some(param) = params.get(numbers.below(params.len().max(1) as u32) as usize) else {
                return "nothing".into();
            };
            let Some(value) = other(param, numbers) else { return "nothing".into() };
            let said = format!("`{}` = {value}", param.path);
            let before = shipped.request.params.insert(param.path.clone(), value);
            let memory = shipped.plan().memory;
            if memory.unshared + memory.outside > LARGEST {
                // Steps by steps a size goes up to where a frame takes minutes.
                match before {
                    Some(before) => shipped.request.params.insert(param.path.clone(), before),
                    None => shipped.request.params.remove(&param.path),
                };
                return format!("nothing, since {said} is too large");
            }
            shipped.prepare();
            said
        }
    }
}

fn drive(engine: &mut Engine, name: &str, alter: fn(&mut Plan)) {
    let steps = std::env::var("MENISCUS_STEPS").ok().and_then(|count| count.parse().ok()).unwrap_or(STEPS);
    let mut shipped = Shipped::new(engine, name, alter);
    let mut numbers = Numbers(0x5eed);
    let mut done = vec!["nothing".to_owned()];
    let (mut ran, mut declared) = (0, 0);
    for _ in 0..steps {
        ran += shipped.run(false).passes.len();
        declared += shipped.run(true).passes.len();
        shipped.same().unwrap_or_else(|what| panic!("{name}: {what} after {}", done.join(", ")));
        done.push(change(&mut shipped, &mut numbers));
    }
    println!("{name}: {ran} of {declared} passes ran in {steps} frames; {} outputs were compared", shipped.looked_at);
}

/// The cases of each graph, by themselves: a graph may take long.
macro_rules! each {
    ($($graph:ident),* $(,)?) => {
        const TESTED: &[&str] = &[$(concat!(stringify!($graph), ".ron")),*];

        $(pub mod $graph {
            use super::*;

            const NAME: &str = concat!(stringify!($graph), ".ron");

            pub fn orbiting_runs_what_sees_the_camera(engine: &mut Engine) {
                orbiting(engine, NAME);
            }

            pub fn a_camera_that_was_forgotten_is_caught(engine: &mut Engine) {
                forgotten_camera(engine, NAME);
            }

            pub fn a_parameter_runs_what_has_it_as_a_cause(engine: &mut Engine) {
                parameters(engine, NAME, 0);
            }

            pub fn another_parameter_runs_what_has_it_as_a_cause(engine: &mut Engine) {
                parameters(engine, NAME, 1);
            }

            pub fn pictures_equal_those_of_full_runs(engine: &mut Engine) {
                drive(engine, NAME, |_| ());
            }

            pub fn shared_memory_holds_nothing_that_is_missed(engine: &mut Engine) {
                drive(engine, NAME, poison::shared);
            }

            pub fn the_smallest_policy_holds_what_its_plan_says(engine: &mut Engine) {
                peak::holds_what_its_plan_says(engine, NAME);
            }
        })*
    };
}

each!(imai2014, imai2016, iwasaki2006, ripples);

pub fn each_has_its_cases(_: &mut Engine) {
    assert_eq!(graphs(), TESTED, "a shipped graph that is not listed above");
}
