//! Making a plan ready to run: memory, pipelines and what they bind, all aside, so that a
//! failure leaves the runner before as it was.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::bind::{Fixed, references};
use super::carry::{self, Carried, Content};
use super::claims::Claimant;
use super::clear;
use super::compile::Compiler;
use super::convert;
use super::cuts::Cuts;
use super::errors;
use super::gpu::Gpu;
use super::kernels;
use super::materials::Materials;
use super::meshes::{self, ByFaces};
use super::mips;
use super::pipeline::{Pipeline, Recipe, RecipeKind, Source, Stage};
use super::pool::Pool;
use super::report::{BuildReport, Report};
use super::run::{StepInfo, Variants};
use super::statistics::Asked;
use super::timing::Timing;
use super::uniform::Uniforms;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::plan::changes::Changes;
use crate::plan::merge;
use crate::plan::model::{Draw, ObjectRef, Origin, Pass, PassKind, Plan, ShaderUse};

/// A device with the pipelines that were made on it.
#[derive(Debug)]
pub struct Engine {
    gpu: Gpu,
    compiler: Compiler,
}

/// A plan made ready to run, with its memory.
#[derive(Debug)]
pub struct Runner {
    pub(super) plan: Plan,
    pub(super) pool: Pool,
    /// Where memory is given back in the middle of a frame.
    pub(super) cuts: Cuts,
    /// Bytes that the last frame held at once, at the most.
    pub(super) peak: u64,
    pub(super) pipelines: Vec<Option<Arc<Pipeline>>>,
    /// Of draws of meshes.
    pub(super) by_faces: Vec<Option<ByFaces>>,
    pub(super) materials: Materials,
    pub(super) variants: Vec<Variants>,
    pub(super) rings_of: Vec<Vec<usize>>,
    /// For each pass whether it is inside `Steps`, and its unit: what each frame asks of all.
    pub(super) parts: Vec<(bool, usize)>,
    /// The passes that settle counted buffers as often as a frame has steps, each with its place among all that settle.
    pub(super) settles: Vec<(u64, usize)>,
    /// For each pass the first one of the render pass that it may share.
    pub(super) leaders: Vec<usize>,
    pub(super) uniforms: Uniforms,
    pub(super) fixed: Fixed,
    pub(super) claimant: Claimant,
    pub(super) timing: Timing,
    /// How far each ring has turned.
    pub(super) rotation: Vec<usize>,
    /// Steps since the reset, of each `Steps`.
    pub(super) done: Vec<u64>,
    pub(super) inputs_filled: bool,
    /// What changed since each unit ran.
    pub(super) changes: Changes,
    /// Of each object, whose content it has.
    pub(super) sources: Vec<Content>,
    /// Of each object, a number that is another whenever its content may be.
    pub(super) stamps: Vec<u64>,
    /// Each object that passes write, with the unit that does.
    pub(super) writers: Vec<(usize, usize)>,
    /// Which passes run in the frame at hand.
    pub(super) chosen: Vec<bool>,
    /// The steps of the frame at hand.
    pub(super) due: Vec<StepInfo>,
    /// Each `Steps`, in the order of their passes.
    pub(super) steps_in_order: Vec<usize>,
    /// How far rings had turned and how many steps were done before the frame at hand.
    pub(super) before: (Vec<usize>, Vec<u64>),
    /// Whether passes run whose results are there already.
    pub(super) runs_all: bool,
    pub(super) last: Option<Report>,
    /// Statistics on their way back.
    pub(super) asked: Option<Asked>,
    build: BuildReport,
    kept_inputs: Vec<bool>,
}

/// A preparation that failed, with the runner before as it was.
#[derive(Debug)]
pub struct Refused {
    pub diagnostics: Diagnostics,
    pub previous: Option<Runner>,
}

impl Engine {
    pub fn new(gpu: Gpu) -> Self {
        Self { compiler: Compiler::new(&gpu), gpu }
    }

    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// What makes this engine's pipelines, for another thread to do so aside.
    pub fn compiler(&self) -> Compiler {
        self.compiler.clone()
    }

    /// Builds all that a plan needs beside what runs. Memory, state and pipelines whose
    /// description did not change go over from the runner before.
    ///
    /// # Errors
    /// With all that the device lacks or refuses, and the runner before, intact.
    pub fn prepare(&mut self, plan: Plan, previous: Option<Runner>) -> Result<Runner, Box<Refused>> {
        match self.build(plan, previous.as_ref()) {
            Ok(runner) => Ok(runner),
            Err(diagnostics) => Err(Box::new(Refused { diagnostics, previous })),
        }
    }

    fn build(&mut self, plan: Plan, previous: Option<&Runner>) -> Result<Runner, Diagnostics> {
        self.gpu.check()?;
        check_features(&self.gpu, &plan)?;
        let (pipelines, by_faces, compiled) = self.compiler.pipelines(&plan)?;
        let state_kept = state_kept(&plan, previous);
        let (pool, cuts) = Pool::new(&self.gpu, &plan, previous.map(|p| &p.pool), &state_kept)?;
        let fixed = errors::scoped(&self.gpu, || Fixed::new(&self.gpu, &plan))
            .map_err(|e| Diagnostic::error(Code::DEVICE, format!("the device refused the engine's buffers: {e}")))?;
        let kept_inputs = (0..plan.objects.len()).map(|id| is_input(&plan, id) && pool.memory(id).is_some()).collect();
        let leaders = merge::leaders(&plan, &|id| pool.handle(id).number());
        let draws_joined = leaders.iter().enumerate().filter(|(pass, leader)| pass != *leader).count();
        let (rotation, done) = progress(&plan, previous, &state_kept);
        let materials = Materials::new(&self.gpu, &plan, previous.map(|p| &p.materials));
        let Carried { changes, sources, stamps } = carry::carry(&plan, &pool, previous);
        let uniforms = Uniforms::new(&self.gpu, &plan, &changes)?;
        let mut runner = Runner {
            changes,
            sources,
            stamps,
            writers: carry::writers(&plan),
            chosen: Vec::with_capacity(plan.passes.len()),
            due: Vec::new(),
            steps_in_order: steps_in_order(&plan),
            before: (Vec::with_capacity(rotation.len()), Vec::with_capacity(done.len())),
            runs_all: previous.is_some_and(|p| p.runs_all),
            pipelines,
            by_faces,
            materials,
            variants: plan.passes.iter().map(|_| Variants::default()).collect(),
            parts: plan.passes.iter().map(|pass| (pass.steps.is_some(), pass.unit)).collect(),
            settles: settles(&plan),
            rings_of: plan.passes.iter().map(rings_of).collect(),
            timing: Timing::new(&self.gpu, &plan),
            claimant: previous.map_or_else(|| Claimant::new(self.gpu.claims()), |p| p.claimant.clone()),
            leaders,
            rotation,
            done,
            inputs_filled: false,
            last: previous.and_then(|p| carry::last_report(&plan, p)),
            asked: None,
            build: BuildReport {
                pipelines_built: compiled.built,
                pipelines_reused: compiled.reused,
                draws_joined,
                memory_bytes: pool.bytes(),
                state_kept: plan.steps.iter().map(|s| s.path.clone()).zip(state_kept).collect(),
            },
            kept_inputs,
            plan,
            pool,
            cuts,
            peak: 0,
            uniforms,
            fixed,
        };
        runner.bind_all(&self.gpu)?;
        self.gpu.check()?;
        runner.claim_what_is_written()?;
        // Last, when nothing refuses the plan any more: it writes to memory that the runner before has too.
        if let Some(before) = previous {
            runner.take_answers(&self.gpu, before)?;
        }
        Ok(runner)
    }

    /// A pipeline of the engine's own, outside any preparation.
    pub(super) fn kernel(&self, recipe: &Recipe, label: &str) -> Result<Arc<Pipeline>, String> {
        self.compiler.kernel(recipe, label)
    }
}

impl Runner {
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// What the preparation made and what it found made.
    pub fn build_report(&self) -> &BuildReport {
        &self.build
    }

    /// Whether an input's object still has what it had in the runner before, so that nobody
    /// needs to upload it again if it did not change.
    pub fn keeps_input(&self, object: usize) -> bool {
        self.kept_inputs.get(object) == Some(&true)
    }

    /// Bytes of textures and buffers that are held now, without what others share with it.
    pub fn memory_bytes(&self) -> u64 {
        self.pool.bytes() + self.materials.bytes()
    }

    /// Bytes of textures and buffers that a frame holds at once, at the most: more than are held now
    /// where it is cut into parts.
    pub fn most_bytes(&self) -> u64 {
        self.memory_bytes() + self.later_bytes()
    }

    /// Starts all state anew: zeroed memory, no step done.
    ///
    /// # Errors
    /// If the device refuses the memory.
    pub fn reset_state(&mut self, engine: &Engine) -> Result<(), Diagnostic> {
        for object in 0..self.plan.objects.len() {
            if matches!(self.plan.objects[object].origin, Origin::State(_)) {
                // New memory is zeroed by wgpu, whatever its format.
                self.pool.forget(object);
                self.pool.ensure(engine.gpu(), &self.plan, object)?;
                self.forget_variants(object);
            }
        }
        self.rotation.fill(0);
        self.done.fill(0);
        self.changes.note_reset();
        Ok(())
    }

    /// Whether all passes run in each frame, also those whose results are there already. Off at
    /// first: a pass runs if something that it depends on has changed.
    pub fn run_all(&mut self, on: bool) {
        self.runs_all = on;
    }

    /// How many units have something to run for, besides what the next frame brings.
    pub fn waiting(&self) -> usize {
        self.changes.waiting()
    }

    /// Makes what passes bind, for the rotation at hand. Those that read inputs without memory
    /// wait for the first frame.
    fn bind_all(&mut self, gpu: &Gpu) -> Result<(), Diagnostics> {
        let mut found = Diagnostics::new();
        for index in 0..self.plan.passes.len() {
            let ready = references(&self.plan.passes[index]).into_iter().all(|r| {
                let object = super::bind::resolve(&self.plan, &self.rotation, r);
                self.pool.memory(object).is_some()
            });
            if ready && let Err(diagnostic) = self.ensure_variant(gpu, index) {
                found.push(diagnostic);
            }
        }
        if found.is_empty() { Ok(()) } else { Err(found) }
    }
}

fn is_input(plan: &Plan, object: usize) -> bool {
    plan.objects[object].origin.input().is_some()
}

fn check_features(gpu: &Gpu, plan: &Plan) -> Result<(), Diagnostic> {
    let missing = plan.needs.features - gpu.features();
    if missing.is_empty() {
        return Ok(());
    }
    let names: Vec<String> = missing.iter_names().map(|(name, _)| name.to_lowercase().replace('_', "-")).collect();
    Err(Diagnostic::error(
        Code::DEVICE_LIMIT,
        format!("`{}` needs {}, which this device lacks", plan.graph.display(), names.join(", ")),
    )
    .hint("`If(test: \"device(feature)\")` can choose another way for such devices"))
}

fn settles(plan: &Plan) -> Vec<(u64, usize)> {
    let is_one = |index: &usize| matches!(plan.passes[*index].kind, PassKind::Settle { .. });
    let all = (0..).zip((0..plan.passes.len()).filter(is_one));
    all.filter(|(_, index)| plan.passes[*index].steps.is_some()).collect()
}

fn steps_in_order(plan: &Plan) -> Vec<usize> {
    let mut order: Vec<usize> = (0..plan.steps.len()).collect();
    order.sort_by_key(|s| plan.steps[*s].passes.start);
    order
}

/// The rings that a pass touches, in order.
fn rings_of(pass: &Pass) -> Vec<usize> {
    let mut rings: Vec<usize> = references(pass)
        .into_iter()
        .filter_map(|r| match r {
            ObjectRef::Ring { ring, .. } => Some(ring),
            ObjectRef::Fixed(_) => None,
        })
        .collect();
    rings.sort_unstable();
    rings.dedup();
    rings
}

/// All state of one `Steps` goes on together, or none of it: its key, objects and rings must be
/// what they were.
fn state_kept(plan: &Plan, previous: Option<&Runner>) -> Vec<bool> {
    let kept = |index: usize| {
        let old = &previous?.plan;
        let at = old.steps.iter().position(|s| s.path == plan.steps[index].path)?;
        let same = old.steps[at].key == plan.steps[index].key && state(old, at) == state(plan, index);
        Some(same && ring_paths(old, at) == ring_paths(plan, index))
    };
    (0..plan.steps.len()).map(|index| kept(index) == Some(true)).collect()
}

fn state(plan: &Plan, steps: usize) -> BTreeMap<&str, &crate::plan::model::ObjectKind> {
    let objects = plan.objects.iter().filter(|o| o.origin == Origin::State(steps));
    objects.map(|o| (o.path.as_str(), &o.kind)).collect()
}

fn ring_paths(plan: &Plan, steps: usize) -> Vec<(Vec<&str>, usize)> {
    let rings = plan.rings.iter().filter(|r| r.steps == steps);
    rings.map(|r| (r.objects.iter().map(|o| plan.objects[*o].path.as_str()).collect(), r.turn)).collect()
}

/// How far rings have turned and how many steps are done: from the runner before where state
/// goes on.
fn progress(plan: &Plan, previous: Option<&Runner>, state_kept: &[bool]) -> (Vec<usize>, Vec<u64>) {
    let old_steps = |index: usize| {
        let old = previous.filter(|_| state_kept[index])?;
        old.plan.steps.iter().position(|s| s.path == plan.steps[index].path).map(|at| (old, at))
    };
    let done = (0..plan.steps.len()).map(|s| old_steps(s).map_or(0, |(old, at)| old.done[at])).collect();
    let rotation = plan.rings.iter().enumerate().map(|(index, ring)| {
        let (old, at) = old_steps(ring.steps)?;
        // The rings of equal blocks are equal and in the same order.
        let nth = plan.rings[..index].iter().filter(|r| r.steps == ring.steps).count();
        let same = old.plan.rings.iter().zip(&old.rotation).filter(|(r, _)| r.steps == at).nth(nth)?;
        Some(*same.1)
    });
    (rotation.map(Option::unwrap_or_default).collect(), done)
}

/// What the pipeline of a pass is made from.
pub(super) fn recipe(gpu: &Gpu, plan: &Plan, pass: &Pass) -> Result<Option<Recipe>, String> {
    match &pass.kind {
        PassKind::Compute { shader, .. } => compute_recipe(plan, shader).map(Some),
        PassKind::Draw(draw) => draw_recipe(plan, draw).map(Some),
        PassKind::Clear { view, value } => Ok(clear::needs_fill(plan, view, *value).then(kernels::fill)),
        PassKind::Mips { texture } => {
            let object = super::pool::candidates(plan, *texture).first().copied().ok_or("an empty ring")?;
            mips::recipe(gpu, plan, object).map(Some)
        }
        PassKind::Settle { .. } => Ok(Some(kernels::settle())),
        PassKind::Copy { .. } | PassKind::Arguments { .. } => Ok(None),
    }
}

fn compute_recipe(plan: &Plan, shader: &ShaderUse) -> Result<Recipe, String> {
    let stage = stage(plan, shader, shader.compute.as_deref())?.ok_or("a compute pass without a compute entry")?;
    Ok(Recipe { layout: convert::layout(plan, &shader.bindings), kind: RecipeKind::Compute(stage) })
}

fn draw_recipe(plan: &Plan, draw: &Draw) -> Result<Recipe, String> {
    let vertex = stage(plan, &draw.shader, draw.shader.vertex.as_deref())?.unwrap_or_else(kernels::fullscreen);
    let fragment = stage(plan, &draw.shader, draw.shader.fragment.as_deref())?;
    Ok(Recipe {
        layout: convert::layout(plan, &draw.shader.bindings),
        kind: RecipeKind::Draw {
            vertex,
            fragment,
            vertices: meshes::slots(draw),
            targets: draw.color.iter().map(|t| Some(convert::color_target(t))).collect(),
            primitive: convert::primitive(draw),
            depth: draw.depth.as_ref().map(convert::depth_stencil).map(Box::new),
            samples: draw.samples.max(1),
        },
    })
}

fn stage(plan: &Plan, shader: &ShaderUse, entry: Option<&str>) -> Result<Option<Stage>, String> {
    let Some(entry) = entry else { return Ok(None) };
    let module = plan.modules.get(shader.module).ok_or_else(|| format!("there is no module {}", shader.module))?;
    Ok(Some(Stage {
        source: Source::Module(Arc::clone(module)),
        entry: entry.into(),
        constants: shader.constants.clone(),
    }))
}
