//! Planning: from a checked graph and the facts of a frame to a plan of plain data.
//!
//! [`instantiate`] is a pure function. It touches no device and no file, and what it gives either
//! runs without an error of wgpu's on a device that has what [`model::Needs`] says, or is
//! diagnostics.

mod budget;
pub mod changes;
mod cull;
mod cuts;
mod examine;
pub mod explain;
pub mod fields;
mod fits;
mod flow;
mod insert;
mod lower;
pub mod memory;
pub mod merge;
pub mod meshes;
pub mod model;
pub mod needs;
mod order;
pub mod packing;
pub mod print;
mod state;
pub mod stats;
mod units;
pub mod unstored;
mod unused;
mod usages;

use std::collections::{BTreeMap, BTreeSet};

pub use examine::{Findings, examine};
use lower::{Entity, Lowering};
pub(crate) use lower::{input_fields, stand_in_texture};
use model::{Object, ObjectId, ObjectRef, Output, Plan, Request};

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::program::Program;

/// Makes a plan (rule 36): flattens, takes branches, unrolls loops, evaluates every expression,
/// applies all rules to the flat list, and derives what to run, in what memory.
///
/// # Errors
/// Everything that is wrong, at once where one fault does not hide another.
pub fn instantiate(program: &Program, request: &Request) -> Result<Plan, Diagnostics> {
    let mode = Mode { stand_in: false, reorder: true };
    let planned = |program: &Program, request: &Request| plan(program, request, mode);
    planned(program, request).map_err(|found| fits::explain(found, request, program, planned))
}

/// The same with every pass where the program has it, for comparison: what comes out is equal.
///
/// # Errors
/// As [`instantiate`].
pub fn instantiate_in_program_order(program: &Program, request: &Request) -> Result<Plan, Diagnostics> {
    plan(program, request, Mode { stand_in: false, reorder: false })
}

/// The same for a file by itself, with [`crate::check::stand_in`]'s request: what nothing
/// describes is made up, and every output counts.
///
/// # Errors
/// As [`instantiate`].
pub fn instantiate_stand_in(program: &Program, request: &Request) -> Result<Plan, Diagnostics> {
    plan(program, request, Mode { stand_in: true, reorder: true })
}

/// How to plan.
#[derive(Clone, Copy)]
struct Mode {
    /// A file by itself: what nothing describes is made up, and every output counts.
    stand_in: bool,
    /// Passes that may share one of the device's come together.
    reorder: bool,
}

fn plan(program: &Program, request: &Request, mode: Mode) -> Result<Plan, Diagnostics> {
    let Lowered { mut lowering, outputs, roots, stats, culled, warnings } = lowered(program, request, mode.stand_in)?;
    let argument_slots = insert::insert(&mut lowering);
    insert::cover_steps(&mut lowering);
    let given = outputs.iter().flat_map(|output| lowering.object_ids(output.object));
    let own: BTreeSet<ObjectId> = roots.iter().copied().chain(given).collect();
    let order = if mode.reorder { order::order(&mut lowering, &own) } else { model::Order::default() };
    let (units, made_from) = units::units(&mut lowering);
    state::seal(&mut lowering, &made_from);
    if lowering.diagnostics.has_errors() {
        return Err(lowering.diagnostics);
    }
    mark_unordered(&mut lowering);
    let told = Told { culled, order, warnings, stats };
    finish(lowering, outputs, &own, told, units, argument_slots)
}

/// A program as flat passes of which some were left out: all rules hold but those of state, and of
/// what the device has.
struct Lowered<'a> {
    lowering: Lowering<'a>,
    outputs: Vec<Output>,
    /// What must be there after the last pass.
    roots: Vec<ObjectId>,
    stats: Vec<model::Stat>,
    culled: Vec<model::Culled>,
    warnings: Diagnostics,
}

fn lowered<'a>(program: &'a Program, request: &'a Request, stand_in: bool) -> Result<Lowered<'a>, Diagnostics> {
    let mut lowering = Lowering::new(program, request, stand_in);
    unknown_params(&mut lowering);
    lowering.run();
    let outputs = outputs(&mut lowering);
    let stats = lowering.stats();
    let mut roots = roots(&mut lowering, &outputs, stand_in);
    if lowering.diagnostics.has_errors() {
        return Err(lowering.diagnostics);
    }
    flow::check(&mut lowering, &outputs);
    tables(&mut lowering);
    if lowering.diagnostics.has_errors() {
        return Err(lowering.diagnostics);
    }
    // One plan says nothing about the others: "unused" is for checks, which compare them.
    let mut warnings = if stand_in { unused::unused(&lowering) } else { Diagnostics::new() };
    let of_stats: Vec<ObjectRef> = stats.iter().flat_map(|s| &s.probes).map(|probe| probe.object).collect();
    let unread = if stand_in { unused::unread(&lowering, &outputs, &of_stats) } else { Vec::new() };
    // A file by itself shows all passes that somebody may ask for.
    let looked_at: Vec<ObjectId> = of_stats.iter().flat_map(|object| lowering.object_ids(*object)).collect();
    let needed: Vec<ObjectId> = roots.iter().chain(looked_at.iter().filter(|_| stand_in)).copied().collect();
    if request.stats {
        roots.extend(&looked_at);
    }
    let culled = cull::cull(&mut lowering, if request.stats { &roots } else { &needed });
    // What only culled passes write is said of these.
    let written = unused::written(&lowering);
    for (object, was_written, diagnostic) in unread {
        if !was_written || written.contains(&object) {
            // One to an object: none of them is there already.
            warnings.0.push(diagnostic);
        }
    }
    Ok(Lowered { lowering, outputs, roots, stats, culled, warnings })
}

/// The rows that are given must be what the shader's struct asks for.
fn tables(lowering: &mut Lowering<'_>) {
    let mut found = Vec::new();
    for building in &lowering.objects {
        let model::Origin::Input(name) = &building.object.origin else { continue };
        let (Some(model::InputInfo::Table { rows }), Some(layout)) =
            (lowering.request.inputs.get(name), &building.layout)
        else {
            continue;
        };
        // Rows that are made up have no values.
        if rows.iter().all(|row| row.is_empty()) {
            continue;
        }
        if let Err(why) = packing::rows(rows, Some(&layout.item), layout.stride) {
            let message = format!("the rows of `{name}` are not what the shader asks for: {why}");
            let diagnostic = Diagnostic::error(Code::BINDING_MISMATCH, message).at(building.object.span, "the table");
            found.push(diagnostic.see(layout.span, "what it is for the shader"));
        }
    }
    found.into_iter().for_each(|diagnostic| lowering.diagnostics.push(diagnostic));
}

/// What planning says of what it did.
struct Told {
    culled: Vec<model::Culled>,
    order: model::Order,
    warnings: Diagnostics,
    stats: Vec<model::Stat>,
}

/// Puts the plan together, with lifetimes, memory and needs.
fn finish(
    mut lowering: Lowering<'_>,
    outputs: Vec<Output>,
    own: &BTreeSet<ObjectId>,
    told: Told,
    units: Vec<model::Unit>,
    argument_slots: u32,
) -> Result<Plan, Diagnostics> {
    let Told { culled, order, mut warnings, stats } = told;
    let mut objects: Vec<Object> = lowering.objects.iter().map(|b| b.object.clone()).collect();
    let runs: Vec<memory::Runs> = lowering.flat.iter().map(|f| (f.pass.unit, f.pass.steps)).collect();
    let touched: Vec<Vec<ObjectId>> = lowering
        .flat
        .iter()
        .map(|flat| {
            let all: BTreeSet<_> = flat.pass.accesses.iter().flat_map(|a| lowering.object_ids(a.object)).collect();
            all.into_iter().collect()
        })
        .collect();
    memory::lifetimes(&mut objects, &touched, &lowering.steps);
    let memory = memory::share(&objects, &runs, &touched, &units, own);
    let (needs, lacking) = needs::needs(&lowering, &objects.iter().map(|o| o.lifetime.is_some()).collect::<Vec<_>>());
    if lacking.has_errors() {
        lowering.diagnostics.extend(lacking);
        return Err(lowering.diagnostics);
    }
    for diagnostic in lowering.diagnostics.0.drain(..) {
        warnings.push(diagnostic);
    }
    let names = names(&lowering);
    let (asked, features) = (&lowering.request.memory, lowering.request.features);
    let mut plan = Plan {
        graph: lowering.program.root.path.clone(),
        viewport: lowering.request.viewport,
        modules: lowering.modules,
        objects,
        uniforms: lowering.uniforms,
        samplers: lowering.samplers,
        passes: lowering.flat.into_iter().map(|flat| flat.pass).collect(),
        culled,
        order,
        units,
        rings: lowering.rings,
        steps: lowering.steps,
        outputs,
        names,
        memory,
        needs,
        stats,
        params: lowering.params.into_values().collect(),
        structural: lowering.causes.params(&lowering.structural),
        arithmetic: lowering.causes.params(&lowering.arithmetic),
        taken: lowering.program.taken(),
        argument_slots,
        warnings,
    };
    usages::of_the_engine(&mut plan, features);
    // Without shared memory the most draws share a render pass; who runs the plan looks again.
    plan.memory.unstored = unstored::unstored(&plan, &merge::leaders(&plan, &|id| id));
    plan.choose_memory(asked).map_err(|found| *found)?;
    Ok(plan)
}

/// Parameters that were asked for by a name that nothing bears.
fn unknown_params(lowering: &mut Lowering<'_>) {
    for path in lowering.request.params.keys() {
        let Err(known) = lowering.program.has_param(path) else { continue };
        let message = format!("there is no parameter `{path}`");
        let diagnostic = Diagnostic::error(Code::UNKNOWN_NAME, message)
            .at(lowering.program.root.span, "in this graph")
            .nearest(path, known.iter().map(String::as_str))
            .hint("`plan` lists the parameters; what a `Use` gives cannot be set from outside");
        lowering.diagnostics.push(diagnostic);
    }
}

/// The outputs as objects after the last pass.
fn outputs(lowering: &mut Lowering<'_>) -> Vec<Output> {
    let graph = lowering.program.root.clone();
    let mut outputs = Vec::new();
    if graph.outputs.is_empty() && !lowering.diagnostics.has_errors() {
        let diagnostic = Diagnostic::error(Code::MISSING_FIELD, "the graph has no outputs: nothing would run")
            .at(graph.span, "this graph")
            .hint("say `outputs: [\"...\"]`; the first is the picture");
        lowering.diagnostics.push(diagnostic);
    }
    for output in &graph.outputs {
        let entity = lowering.resolve(0, &output.of.value, output.of.span);
        // Parts put out scalars and inputs too; those need no pass.
        if let Some(Entity::Var(var)) = lowering.report(entity) {
            let object = lowering.vars[var].now;
            outputs.push(Output { name: output.name.value.clone(), object, span: output.of.span });
        }
    }
    outputs
}

/// What must be there after the last pass: the first output and what somebody asks for.
fn roots(lowering: &mut Lowering<'_>, outputs: &[Output], all: bool) -> Vec<ObjectId> {
    let count = if all { outputs.len() } else { 1 };
    let mut roots: Vec<ObjectId> = outputs.iter().take(count).flat_map(|o| lowering.object_ids(o.object)).collect();
    let names = names(lowering);
    for asked in lowering.request.roots.clone() {
        let found = names.get(&asked).or_else(|| outputs.iter().find(|o| o.name == asked).map(|o| &o.object));
        match found {
            Some(object) => roots.extend(lowering.object_ids(*object)),
            None => {
                let known: Vec<&str> = names.keys().map(String::as_str).collect();
                let diagnostic = Diagnostic::error(Code::UNKNOWN_NAME, format!("no resource is called `{asked}`"))
                    .at(lowering.program.root.span, "in this graph")
                    .nearest(&asked, known.iter().copied());
                lowering.diagnostics.push(diagnostic);
            }
        }
    }
    roots.sort_unstable();
    roots.dedup();
    roots
}

/// Instance paths of resources, and what is behind them after the last pass.
fn names(lowering: &Lowering<'_>) -> BTreeMap<String, ObjectRef> {
    let mut names = BTreeMap::new();
    for scope in &lowering.scopes {
        for (resource, var) in scope.graph.resources.iter().zip(&scope.resources) {
            let Some(var) = var.filter(|var| *var < lowering.vars.len()) else { continue };
            let name = &resource.name.value;
            let path = if scope.path.is_empty() { name.clone() } else { format!("{}.{name}", scope.path) };
            names.insert(path, lowering.vars[var].now);
        }
    }
    for var in &lowering.vars {
        let building = lowering.object(var.now);
        if !matches!(building.object.origin, model::Origin::Frame | model::Origin::State(_)) {
            names.insert(building.object.path.clone(), var.now);
        }
    }
    names
}

/// What the order of atomics reaches: a pass that uses an atomic's old value, and all that read
/// what it wrote.
fn mark_unordered(lowering: &mut Lowering<'_>) {
    // What steps read may be from the step before.
    let in_steps: BTreeSet<ObjectId> = lowering
        .flat
        .iter()
        .filter(|flat| flat.pass.steps.is_some())
        .flat_map(|flat| flat.pass.accesses.iter().filter(|a| a.read))
        .flat_map(|access| lowering.object_ids(access.object))
        .collect();
    let mut carried: BTreeSet<ObjectId> = BTreeSet::new();
    loop {
        let mut reached = carried.clone();
        for p in 0..lowering.flat.len() {
            let pass = &lowering.flat[p].pass;
            let ids = |access: &model::Access| lowering.object_ids(access.object);
            let reads = |a: &model::Access| a.read && ids(a).any(|id| reached.contains(&id));
            if pass.unordered || pass.accesses.iter().any(reads) {
                let written: Vec<ObjectId> = pass.accesses.iter().filter(|a| a.write).flat_map(ids).collect();
                reached.extend(written);
                lowering.flat[p].pass.unordered = true;
                continue;
            }
            let is_all = |a: &&model::Access| a.whole && whole_object(&lowering.object(a.object).object.kind, a);
            let renewed: Vec<ObjectId> =
                pass.accesses.iter().filter(is_all).map(|a| lowering.object_id(a.object)).collect();
            // A frame may run no step.
            if pass.steps.is_none() {
                renewed.iter().for_each(|id| _ = reached.remove(id));
            }
        }
        let before = carried.len();
        carried.extend(reached.intersection(&in_steps));
        if carried.len() == before {
            return;
        }
    }
}

/// Whether an access covers every mip and layer.
fn whole_object(kind: &model::ObjectKind, access: &model::Access) -> bool {
    match kind {
        model::ObjectKind::Texture(t) => {
            let layers = if t.is_3d { 1 } else { t.layers };
            access.mips == (0..t.mips) && access.layers == (0..layers)
        }
        model::ObjectKind::Buffer(_) => true,
    }
}
