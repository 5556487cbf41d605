//! Building what was loaded on a device, aside, so that a failure leaves what was there.

use std::borrow::Cow;
use std::collections::BTreeMap;

use wgpu_types::{Features, Limits, TextureUsages};

use super::content::{COLOR, Content};
use super::inputs::Input;
use super::meshes::{Meshes, Standing};
use super::sequence::Track;
use super::state::Held;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::engine::{Compiled, Compiler, Engine, Gpu, MaterialImage, MaterialSampler, MaterialSlots, Runner};
use crate::plan;
use crate::plan::meshes::MeshBuffer;
use crate::plan::model::{Buffer, MemoryRequest, Object, ObjectId, ObjectKind, ObjectRef, Origin, Plan, Texture};
use crate::plan::packing;
use crate::scene::meshes::{Filter, Sampler, Wrap};
use crate::scene::{PointerPath, Pointing, convert};

/// A device, and what is built on it.
#[derive(Debug)]
pub struct Session {
    pub(super) engine: Engine,
    pub(super) graph: Option<Runner>,
    pub(super) present: Option<Runner>,
    pub(super) content: Option<Content>,
    /// Room that counted buffers turned out to need, by instance path.
    pub(super) capacities: BTreeMap<String, u64>,
    /// Where moving meshes stand.
    pub(super) standing: Standing,
    /// What was pointed at while pictures were shown.
    pub(super) pointed: PointerPath,
}

/// Plans content, and compiles what its plans need, beside a session and on any thread.
#[derive(Clone, Debug)]
pub struct Builder {
    compiler: Compiler,
    /// Room that counted buffers turned out to need, by instance path.
    pub capacities: BTreeMap<String, u64>,
}

/// Content with its plans, for [`Session::install`].
#[derive(Debug)]
pub struct Planned {
    pub content: Content,
    pub plan: Plan,
    pub(super) present: Plan,
    /// What was compiled aside.
    pub compiled: Compiled,
}

/// What a build made.
#[derive(Clone, Debug, Default)]
pub struct Built {
    pub pipelines_built: usize,
    pub pipelines_reused: usize,
    /// Of those that were built, how many only while installing, which whoever draws waited for.
    pub pipelines_late: usize,
    /// Bytes of textures and buffers.
    pub memory_bytes: u64,
    /// Notes and warnings of planning.
    pub diagnostics: Diagnostics,
    /// Which state starts anew, and why; for those that let it go on.
    pub resets: Diagnostics,
}

impl Session {
    pub fn new(gpu: Gpu) -> Self {
        Self {
            engine: Engine::new(gpu),
            graph: None,
            present: None,
            content: None,
            capacities: BTreeMap::new(),
            standing: Standing::default(),
            pointed: PointerPath::default(),
        }
    }

    pub fn gpu(&self) -> &Gpu {
        self.engine.gpu()
    }

    /// The plan of the scene's graph, once it is built.
    pub fn plan(&self) -> Option<&Plan> {
        self.graph.as_ref().map(Runner::plan)
    }

    /// The plan of the graph that presents the picture, once it is built.
    pub fn present_plan(&self) -> Option<&Plan> {
        self.present.as_ref().map(Runner::plan)
    }

    pub fn content(&self) -> Option<&Content> {
        self.content.as_ref()
    }

    /// Records what somebody points at from a time on: steps see it at their own times, also when they
    /// are done again. From then on it is in place of the scene's pointers.
    pub fn point(&mut self, at: Pointing) {
        if at.fault().is_none() {
            self.pointed.record(at);
        }
    }

    /// Forgets what was recorded: the scene's pointers count again.
    pub fn forget_pointing(&mut self) {
        self.pointed = PointerPath::default();
    }

    /// Builds content beside what is there, and swaps it in if all of it works.
    ///
    /// # Errors
    /// With everything that planning or the device refuses; then the session is as it was.
    pub fn build(&mut self, content: Content) -> Result<Built, Diagnostics> {
        let planned = self.builder().plan(content)?;
        self.install(planned)
    }

    /// What plans and compiles content for this session, also on another thread.
    pub fn builder(&self) -> Builder {
        Builder { compiler: self.engine.compiler(), capacities: self.capacities.clone() }
    }

    /// Swaps in what was planned, if the device gives all that it needs.
    ///
    /// # Errors
    /// With everything that the device refuses; then the session is as it was.
    pub fn install(&mut self, planned: Planned) -> Result<Built, Diagnostics> {
        let Planned { content, plan, present: present_plan, compiled } = planned;
        let warnings = plan.warnings.clone();
        let held = self.plan().map(Held::of).unwrap_or_default();
        let present_before = self.present.take();
        let mut present = match self.engine.prepare(present_plan, present_before) {
            Ok(runner) => runner,
            Err(refused) => {
                self.present = refused.previous;
                return Err(refused.diagnostics);
            }
        };
        let mut graph = match self.engine.prepare(plan, self.graph.take()) {
            Ok(runner) => runner,
            Err(refused) => {
                (self.graph, self.present) = (refused.previous, Some(present));
                return Err(refused.diagnostics);
            }
        };
        let before = self.content.take();
        self.standing.at_s = None;
        let uploaded =
            upload(&self.engine, &mut graph, &content.inputs, before.as_ref().map(|c| &c.inputs)).and_then(|()| {
                let before = before.as_ref().map(|c| &c.present_inputs);
                upload(&self.engine, &mut present, &content.present_inputs, before)
            });
        let reports = [graph.build_report(), present.build_report()];
        let reused: usize = reports.iter().map(|r| r.pipelines_reused).sum();
        let pipelines_late = reports.iter().map(|r| r.pipelines_built).sum();
        let built = Built {
            pipelines_built: compiled.built + pipelines_late,
            pipelines_late,
            pipelines_reused: reused.saturating_sub(compiled.built),
            memory_bytes: graph.most_bytes() + present.most_bytes(),
            diagnostics: warnings,
            resets: held.resets(graph.plan(), &reports[0].state_kept),
        };
        (self.graph, self.present) = (Some(graph), Some(present));
        // Without content, what was uploaded in part is uploaded whole at the next build.
        uploaded?;
        self.content = Some(content);
        Ok(built)
    }

    /// Whether all passes run for each picture, also those whose results are there already.
    pub fn run_all(&mut self, on: bool) {
        for runner in [&mut self.graph, &mut self.present].into_iter().flatten() {
            runner.run_all(on);
        }
    }

    /// Swaps in other inputs, such as the next frame's; what they do not change stays as it is.
    ///
    /// # Errors
    /// With everything that planning or the device refuses; then the session is as it was.
    pub fn feed(&mut self, inputs: BTreeMap<String, Input>) -> Result<Diagnostics, Diagnostics> {
        let Some(mut content) = self.content.clone().filter(|_| !inputs.is_empty()) else {
            return Ok(Diagnostics::new());
        };
        content.feed(inputs);
        self.build(content).map(|built| built.diagnostics)
    }

    /// The numbered files that inputs are frames of.
    pub fn tracks(&self) -> &[Track] {
        self.content.as_ref().map_or(&[], |content| &content.tracks)
    }

    /// Whether GPU times are taken, where the device can.
    pub fn time_passes(&mut self, on: bool) {
        for runner in [&mut self.graph, &mut self.present].into_iter().flatten() {
            runner.time_passes(on);
        }
    }

    /// Plans and prepares the graph again with more room; inputs stay.
    pub(super) fn grow(&mut self) -> Result<(), Diagnostics> {
        let Some(content) = self.content.take() else { return Ok(()) };
        self.build(content).map(|_| ())
    }
}

impl Builder {
    /// Plans the content's graph and the one that presents it.
    ///
    /// # Errors
    /// With everything that planning finds.
    pub fn plan(&self, content: Content) -> Result<Planned, Diagnostics> {
        let gpu = self.compiler.gpu();
        check_size(content.viewport, &gpu.limits())?;
        let (plan, present) = content.plans(gpu.features(), gpu.limits(), &self.capacities)?;
        Ok(Planned { content, plan, present, compiled: Compiled::default() })
    }

    /// Has the driver compile all that the plans need, so that installing them waits for no compiler.
    ///
    /// # Errors
    /// With every pipeline that the device refuses.
    pub fn compile(&self, planned: &mut Planned) -> Result<(), Diagnostics> {
        let present = self.compiler.compile(&planned.present)?;
        let graph = self.compiler.compile(&planned.plan)?;
        planned.compiled = Compiled { built: present.built + graph.built, reused: present.reused + graph.reused };
        Ok(())
    }
}

impl Content {
    /// The plans of the content's graph and of the one that presents it, both within the budget.
    ///
    /// # Errors
    /// With everything that planning finds.
    pub fn plans(
        &self,
        features: Features,
        limits: Limits,
        capacities: &BTreeMap<String, u64>,
    ) -> Result<(Plan, Plan), Diagnostics> {
        let request = self.request(features, limits.clone(), capacities);
        let mut plan = plan::instantiate(&self.program, &request)?;
        let (id, color) = picture(&plan)?;
        let mut present = plan::instantiate(&self.present, &self.present_request(color, features, limits))?;
        share_usages(&mut plan, id, &present);
        let (id, _) = picture(&present)?;
        if let ObjectKind::Texture(texture) = &mut present.objects[id].kind {
            // Windows sample it.
            texture.usages |= TextureUsages::TEXTURE_BINDING;
        }
        let elsewhere = presenting_bytes(&present) + self.material_bytes(&plan);
        plan.choose_memory(&MemoryRequest { elsewhere, ..self.memory.clone() }).map_err(|found| *found)?;
        Ok((plan, present))
    }

    /// Bytes of the textures of materials that a plan binds.
    fn material_bytes(&self, plan: &Plan) -> u64 {
        let of_input = |(name, input): (&String, &Input)| match input {
            Input::Meshes(meshes) if plan.binds_materials(name) => {
                let texels = meshes.images.iter().map(|(image, _)| u64::from(image.width) * u64::from(image.height));
                // Four bytes, and a third of that for mips.
                texels.map(|texels| texels * 16 / 3).sum()
            }
            _ => 0,
        };
        self.inputs.iter().map(of_input).sum()
    }
}

/// Bytes that the presenting graph holds: the picture is not its own.
fn presenting_bytes(present: &Plan) -> u64 {
    let color = present.objects.iter().find(|object| is_color(object));
    let not_its_own = color.map_or(0, |object| plan::memory::bytes(&object.kind));
    present.memory.held(present.memory.policy).saturating_sub(not_its_own)
}

fn check_size(viewport: [u32; 2], limits: &Limits) -> Result<(), Diagnostic> {
    let most = limits.max_texture_dimension_2d;
    if viewport.iter().all(|side| *side <= most) {
        return Ok(());
    }
    let [width, height] = viewport;
    let message = format!("{width} x {height} pixels are more than this device can do: {most} each way");
    Err(Diagnostic::error(Code::USAGE, message))
}

/// The picture is made for what the presenting graph does with it, too.
fn share_usages(plan: &mut Plan, id: ObjectId, present: &Plan) {
    let color = present.objects.iter().find(|o| is_color(o));
    if let (ObjectKind::Texture(texture), Some(ObjectKind::Texture(asked))) =
        (&mut plan.objects[id].kind, color.map(|o| &o.kind))
    {
        texture.usages |= asked.usages;
    }
}

/// Whether an object of the presenting graph is the picture that it takes.
pub(super) fn is_color(object: &Object) -> bool {
    matches!(&object.origin, Origin::Input(name) if name == COLOR)
}

/// The first output, which is the picture.
fn picture(plan: &Plan) -> Result<(ObjectId, Texture), Diagnostic> {
    let path = plan.graph.display();
    let Some(output) = plan.outputs.first() else {
        return Err(Diagnostic::error(Code::WRONG_KIND, format!("`{path}` has no output to show")));
    };
    let object = match output.object {
        ObjectRef::Fixed(id) => Some(id),
        ObjectRef::Ring { ring, index } => plan.rings.get(ring).and_then(|r| r.objects.get(index)).copied(),
    };
    match object.and_then(|id| Some((id, plan.objects.get(id)?))) {
        Some((id, object)) => match &object.kind {
            ObjectKind::Texture(texture) if texture.layers == 1 && !texture.is_3d => Ok((id, texture.clone())),
            _ => {
                let message = format!("the first output of `{path}` is the picture, and `{}` is none", output.name);
                Err(Diagnostic::error(Code::WRONG_KIND, message).at(object.span, "this is no 2D texture"))
            }
        },
        None => Err(Diagnostic::error(Code::WRONG_KIND, format!("`{path}` has no output to show"))),
    }
}

/// Hands the device the inputs that it does not have already.
fn upload(
    engine: &Engine,
    runner: &mut Runner,
    inputs: &BTreeMap<String, Input>,
    before: Option<&BTreeMap<String, Input>>,
) -> Result<(), Diagnostics> {
    let mut found = Diagnostics::new();
    for id in 0..runner.plan().objects.len() {
        let object = &runner.plan().objects[id];
        let Some(name) = object.origin.input() else { continue };
        let Some(input) = inputs.get(name) else { continue };
        let is_same = before.and_then(|b| b.get(name)).is_some_and(|b| b.is_same(input));
        if is_same && runner.keeps_input(id) {
            continue;
        }
        if let Err(error) = fill(engine, runner, id, input) {
            found.push(error);
        }
    }
    for (name, input) in inputs {
        let Input::Meshes(meshes) = input else { continue };
        let is_same = before.and_then(|b| b.get(name)).is_some_and(|b| b.is_same(input));
        if runner.wants_materials(name)
            && !(is_same && runner.has_materials(name))
            && let Err(error) = materials(engine, runner, name, meshes)
        {
            found.push(error);
        }
    }
    if found.is_empty() { Ok(()) } else { Err(found) }
}

fn fill(engine: &Engine, runner: &mut Runner, id: usize, input: &Input) -> Result<(), Diagnostic> {
    let object = &runner.plan().objects[id];
    match (&object.origin, &object.kind, input) {
        (Origin::Attribute { .. }, _, Input::Particles(particles)) if particles.set.count == 0 => Ok(()),
        (Origin::Attribute { attribute, present, .. }, ObjectKind::Buffer(buffer), Input::Particles(particles)) => {
            let column = particles.set.attribute(attribute).filter(|_| *present);
            let bytes = match column {
                Some(column) => convert::rows(column, buffer.item.as_ref(), buffer.stride)
                    .map_err(|why| Diagnostic::error(Code::BINDING_MISMATCH, why).at(object.span, "asked for here"))?,
                // An optional attribute that the file lacks is all zeros.
                None => vec![0; usize::try_from(buffer.bytes()).unwrap_or(0)].into(),
            };
            runner.upload_buffer(engine, id, &bytes)
        }
        (Origin::Mesh { buffer: which, .. }, ObjectKind::Buffer(buffer), Input::Meshes(meshes)) => {
            let bytes = mesh_bytes(meshes, which, buffer)
                .map_err(|why| Diagnostic::error(Code::BINDING_MISMATCH, why).at(object.span, "asked for here"))?;
            runner.upload_buffer(engine, id, &bytes)
        }
        (_, ObjectKind::Texture(_), Input::Image(image)) => {
            runner.upload_texture(engine, id, 0, 0, bytemuck::cast_slice(image.texels.as_flattened()))
        }
        (_, ObjectKind::Buffer(buffer), Input::Table(rows)) => {
            let bytes = packing::rows(rows, buffer.item.as_ref(), buffer.stride)
                .map_err(|why| Diagnostic::error(Code::BINDING_MISMATCH, why).at(object.span, "asked for here"))?;
            runner.upload_buffer(engine, id, &bytes)
        }
        // The picture that is presented is shared, not uploaded.
        (Origin::Input(name), ..) if name == COLOR => Ok(()),
        _ => Ok(()),
    }
}

/// What a buffer of meshes holds at time 0.
fn mesh_bytes<'a>(meshes: &'a Meshes, which: &MeshBuffer, buffer: &Buffer) -> Result<Cow<'a, [u8]>, String> {
    Ok(match which {
        MeshBuffer::Bodies => meshes.bodies().into(),
        MeshBuffer::Instances => meshes.instances(0.0).into(),
        MeshBuffer::Vertices(attribute) => meshes.vertices(*attribute).into(),
        MeshBuffer::Triangles => meshes.triangles().into(),
        MeshBuffer::Value { name, default } => {
            meshes.value(name, default.as_ref(), buffer.item.as_ref(), buffer.stride)?.into()
        }
        MeshBuffer::Materials => meshes.materials(buffer.item.as_ref(), buffer.stride)?.into(),
    })
}

/// Hands over the textures of an input's materials.
fn materials(engine: &Engine, runner: &mut Runner, name: &str, meshes: &Meshes) -> Result<(), Diagnostic> {
    let images: Vec<MaterialImage<'_>> = meshes
        .images
        .iter()
        .map(|(image, is_srgb)| MaterialImage {
            width: image.width,
            height: image.height,
            is_srgb: *is_srgb,
            texels: &image.texels,
        })
        .collect();
    let slots = meshes.uses().zip(&meshes.textures).map(|(uses, images)| {
        let mut slots = MaterialSlots::default();
        for (slot, (used, image)) in slots.iter_mut().zip(uses.into_iter().zip(images)) {
            *slot = used.zip(*image).map(|(used, image)| (image, material_sampler(used.sampler)));
        }
        slots
    });
    runner.upload_materials(engine, name, &images, slots.collect())
}

fn material_sampler(about: Sampler) -> MaterialSampler {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => wgpu_types::AddressMode::Repeat,
        Wrap::Mirror => wgpu_types::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu_types::AddressMode::ClampToEdge,
    };
    let filter = |filter| match filter {
        Filter::Nearest => wgpu_types::FilterMode::Nearest,
        Filter::Linear => wgpu_types::FilterMode::Linear,
    };
    let mip = about.mip.map(|mip| match mip {
        Filter::Nearest => wgpu_types::MipmapFilterMode::Nearest,
        Filter::Linear => wgpu_types::MipmapFilterMode::Linear,
    });
    let (wrap_u, wrap_v) = (wrap(about.wrap_u), wrap(about.wrap_v));
    MaterialSampler { wrap_u, wrap_v, mag: filter(about.mag), min: filter(about.min), mip }
}
