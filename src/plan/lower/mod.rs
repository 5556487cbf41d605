//! Lowering: flattens parts, takes branches, unrolls loops, evaluates every expression and binds
//! every shader, giving the flat list of passes that all later steps work on.
//!
//! A graph instance is a [`Scope`]; its resources are variables whose memory swaps change as the
//! list is walked. Resources, `let` names and the scopes of parts are made when something first
//! asks for them, so the order of declarations does not matter.

mod bind;
mod buffers;
mod causes;
mod draw;
mod extent;
mod inputs;
mod materials;
mod measure;
mod meshes;
mod misbound;
mod names;
mod nodes;
mod params;
mod parts;
mod scalars;
mod signature;
mod stats;
mod steps;
mod swaps;
mod targets;
mod textures;
mod transfer;
mod uniform;
mod vars;
mod view;
mod wgsl;

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::sync::Arc;

pub(super) use causes::{CauseKind, CauseNames, CauseSet};
pub(crate) use inputs::input_fields;
pub(super) use names::{Entity, list};
pub(crate) use vars::stand_in_texture;

use super::model::{self, ObjectId, ObjectRef, Pass, Request, UniformBlock};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Span};
use crate::graph::declared::Local;
use crate::graph::expr::Expr;
use crate::graph::model::{Graph, Name, Sampler};
use crate::graph::value::Value;
use crate::program::Program;
use crate::shader::reflect::{Module, Type};
use crate::words::{WordState, Words};

pub(super) type ScopeId = usize;
pub(super) type VarId = usize;

/// Without a `Result`, a fault is pushed to [`Lowering::diagnostics`] and the thing is left out.
pub(super) type Result<T> = std::result::Result<T, Box<Diagnostic>>;

/// What needs a feature of the device: a place, its label, and where its part is used.
pub(super) type FeaturePlace = (Span, &'static str, Vec<Span>);

/// What a flat pass is before units are known.
#[derive(Clone, Debug)]
pub(super) struct FlatPass {
    pub pass: Pass,
    /// What it depends on from outside the graph, by itself.
    pub causes: CauseSet,
    /// The first word of its declaration.
    pub word: Span,
    /// Where the parts that it lies in are used, outermost first.
    pub trace: Vec<Span>,
    /// A counted buffer whose count decides how much it does, and how.
    pub counted: Vec<(ObjectRef, model::ArgumentKind)>,
    /// Arguments of its own that a shader wrote: buffer, byte offset, indexed.
    pub arguments: Option<(ObjectRef, u64, bool)>,
    /// Where each access comes from, beside `pass.accesses`.
    pub places: Vec<Place>,
}

/// Where an access is written down.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// In the graph: the pass, the target or the `bind` entry.
    pub graph: Span,
    /// The shader's variable, if one accesses.
    pub shader: Option<Span>,
    /// How messages call it.
    pub name: Arc<str>,
    /// Texture sampled with more than mip 0 in view: automatic mips must be made before.
    pub samples_mips: bool,
    /// Appends to a counted buffer, or otherwise writes its count.
    pub appends: bool,
}

/// A graph instance: the root, or a part at one place.
#[derive(Debug)]
pub(super) struct Scope {
    pub graph: Arc<Graph>,
    /// Instance path; empty for the root.
    pub path: String,
    pub parent: Option<ScopeId>,
    /// The `Use`s that lead here, outermost first.
    pub trace: Vec<Span>,
    /// What each name declared in this file is.
    pub locals: Arc<Words<Local>>,
    /// Inputs by name to names of the parent.
    pub binds: BTreeMap<String, Name>,
    /// Parameters that the `Use` gave.
    pub given: BTreeMap<String, (Scalar, Span)>,
    pub counters: Vec<(String, i64)>,
    /// What names in WGSL could be.
    spelled: Words<Arc<[Arc<str>]>>,
    /// Blocks of scalars by the pass and the shader's variable.
    packed: HashMap<(Span, usize), Packed, WordState>,
    /// The values of parameters that no `Use` gives, and what feeds inputs, once asked for.
    own_params: Vec<Option<Scalar>>,
    fed: Vec<Option<Entity>>,
    /// What it was given depends on a counter of a loop outside.
    pub given_counts: bool,
    pub children: BTreeMap<String, ScopeId>,
    pub resources: Vec<Option<VarId>>,
    /// What feeds it does not fit, and that was said: its passes are left out.
    pub broken: bool,
    lets: Vec<LetState>,
}

/// A block of scalars that holds in every iteration.
#[derive(Debug)]
struct Packed {
    block: usize,
    causes: CauseSet,
    /// [`Lowering::given_anew`] when it was made.
    given_anew: usize,
}

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "most are known in the end")]
enum LetState {
    Waiting,
    Evaluating,
    Known {
        scalar: Scalar,
        /// It may be another one in a loop's next iteration.
        counts: bool,
    },
}

/// A value of the scalar language with what it depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scalar {
    pub value: model::UniformValue,
    pub causes: CauseSet,
}

/// A texture or buffer under a name; swaps change which memory it has.
#[derive(Clone, Debug)]
pub(super) struct Var {
    pub now: ObjectRef,
}

/// An object while its layout and usages are still being found out.
#[derive(Debug)]
pub(super) struct Building {
    pub object: model::Object,
    /// What the first shader that binds the buffer says of it, and where.
    pub layout: Option<Layout>,
    pub mips_auto: bool,
    /// A stand-in for an input that nothing describes: takes the format that a shader wants.
    pub adapts: bool,
    /// What its size depends on.
    pub causes: CauseSet,
}

#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub header: u32,
    pub stride: u32,
    pub item: Type,
    pub span: Span,
}

pub(super) struct Lowering<'a> {
    pub program: &'a Program,
    pub request: &'a Request,
    /// Nothing outside is known: what is missing is made up. For checking a file by itself.
    pub stand_in: bool,
    pub scopes: Vec<Scope>,
    pub vars: Vec<Var>,
    pub objects: Vec<Building>,
    pub flat: Vec<FlatPass>,
    pub modules: Vec<Arc<Module>>,
    pub uniforms: Vec<UniformBlock>,
    pub samplers: Vec<Sampler>,
    pub rings: Vec<model::Ring>,
    pub steps: Vec<model::Steps>,
    /// Objects whose names swap: each set counts as one.
    pub swapped: Vec<BTreeSet<ObjectId>>,
    pub params: BTreeMap<String, model::Param>,
    pub features: wgpu_types::Features,
    /// What needs each feature first, by its name.
    pub feature_places: BTreeMap<&'static str, FeaturePlace>,
    pub diagnostics: Diagnostics,
    /// Declarations that something asked for, for "unused".
    pub used: HashSet<Span, WordState>,
    /// Causes of the branches and loops around the node that is being lowered.
    structure: Vec<CauseSet>,
    in_steps: Option<usize>,
    /// `[2]`, or `[2][0]` in a loop in a loop.
    iteration: String,
    /// A loop's counter was looked at since this was last put back.
    saw_counter: bool,
    /// How often a part was given other parameters than before.
    given_anew: usize,
    /// How many names are being resolved for one another.
    depth: usize,
    /// Variables of root inputs: `particles.position`, `color`.
    input_vars: BTreeMap<String, VarId>,
    /// Names whose values are being worked out, innermost last: one that comes again is a circle.
    evaluating: Vec<(Span, String)>,
    /// Parameters that more hangs on than what a uniform holds: sizes, counts, tests, constants.
    pub structural: CauseSet,
    /// Parameters that stand in arithmetic, which can fail at other values than these.
    pub arithmetic: CauseSet,
    /// What anything can depend on.
    pub causes: CauseNames,
    /// Iterations and passes so far.
    unrolled: u64,
}

impl<'a> Lowering<'a> {
    pub fn new(program: &'a Program, request: &'a Request, stand_in: bool) -> Self {
        Self {
            program,
            request,
            stand_in,
            scopes: Vec::new(),
            vars: Vec::new(),
            objects: Vec::new(),
            flat: Vec::new(),
            modules: Vec::new(),
            uniforms: Vec::new(),
            samplers: Vec::new(),
            rings: Vec::new(),
            steps: Vec::new(),
            swapped: Vec::new(),
            params: BTreeMap::new(),
            features: wgpu_types::Features::empty(),
            feature_places: BTreeMap::new(),
            diagnostics: Diagnostics::new(),
            used: HashSet::default(),
            structure: Vec::new(),
            in_steps: None,
            iteration: String::new(),
            saw_counter: false,
            given_anew: 0,
            depth: 0,
            input_vars: BTreeMap::new(),
            evaluating: Vec::new(),
            structural: CauseSet::default(),
            arithmetic: CauseSet::default(),
            causes: CauseNames::default(),
            unrolled: 0,
        }
    }

    /// Lowers the whole program. What has errors is left out and reported.
    pub fn run(&mut self) {
        let root = self.add_scope(self.program.root.clone(), String::new(), None, Vec::new());
        self.check_inputs(root);
        self.declare_params(root);
        let passes = self.program.root.clone();
        self.nodes(root, &passes.passes);
        self.turn_rings_into_refs();
    }

    /// Keeps a fault; the caller leaves the thing out.
    pub(super) fn report<T>(&mut self, result: Result<T>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(diagnostic) => {
                self.diagnostics.push(*diagnostic);
                None
            }
        }
    }

    /// Keeps that the plan needs features of the device, and what asked first.
    pub(super) fn need(&mut self, s: ScopeId, features: wgpu_types::Features, at: Span, label: &'static str) {
        for (name, _) in (features - self.features).iter_names() {
            self.feature_places.entry(name).or_insert_with(|| (at, label, self.scopes[s].trace.clone()));
        }
        self.features |= features;
    }

    /// The object behind a reference at the start of a frame: what description it has.
    pub fn object(&self, object: ObjectRef) -> &Building {
        &self.objects[self.object_id(object)]
    }

    pub fn object_id(&self, object: ObjectRef) -> ObjectId {
        match object {
            ObjectRef::Fixed(id) => id,
            ObjectRef::Ring { ring, index } => self.rings[ring].objects[index],
        }
    }

    /// Every object that a reference may stand for: one, or all of a ring.
    pub fn object_ids(&self, object: ObjectRef) -> impl Iterator<Item = ObjectId> + use<> {
        let (one, all) = match object {
            ObjectRef::Fixed(id) => (Some(id), Vec::new()),
            ObjectRef::Ring { ring, .. } => (None, self.rings[ring].objects.clone()),
        };
        one.into_iter().chain(all)
    }

    /// Objects that came to be in a ring only after passes had named them become members of it.
    fn turn_rings_into_refs(&mut self) {
        let mut member = BTreeMap::new();
        for (ring, r) in self.rings.iter().enumerate() {
            for (index, object) in r.objects.iter().enumerate() {
                member.insert(*object, ObjectRef::Ring { ring, index });
            }
        }
        if member.is_empty() {
            return;
        }
        let turn = |object: &mut ObjectRef| {
            if let ObjectRef::Fixed(id) = object
                && let Some(found) = member.get(id)
            {
                *object = *found;
            }
        };
        for flat in &mut self.flat {
            model::each_ref(&mut flat.pass.kind, &mut |object| turn(object));
            flat.pass.accesses.iter_mut().for_each(|access| turn(&mut access.object));
            flat.counted.iter_mut().for_each(|(object, _)| turn(object));
            if let Some((object, _, _)) = &mut flat.arguments {
                turn(object);
            }
        }
        for var in &mut self.vars {
            turn(&mut var.now);
        }
    }
}

impl Scalar {
    pub fn known(value: Value) -> Self {
        Self::caused(value, CauseSet::default())
    }

    pub fn caused(value: Value, causes: CauseSet) -> Self {
        Self { value: model::UniformValue::Known(value), causes }
    }

    pub fn live(expr: Expr, causes: CauseSet) -> Self {
        Self { value: model::UniformValue::Live(expr), causes }
    }
}

/// An error about a thing that was written somewhere in a part: the places that use the part are
/// shown too.
pub(super) fn traced(mut diagnostic: Diagnostic, trace: &[Span]) -> Box<Diagnostic> {
    for span in trace.iter().rev() {
        diagnostic = diagnostic.see(*span, "used here");
    }
    Box::new(diagnostic)
}

pub(super) fn fault(id: Code, message: impl Into<String>, at: Span, label: impl Into<String>) -> Diagnostic {
    Diagnostic::error(id, message).at(at, label)
}
