//! What must run in a frame (rules 37 and 38), as a function of plain data.
//!
//! A unit is to run if one of its causes changed since it last ran, if its passes are others than
//! those that ran, or if what it touches has new memory. From there it goes on: to the units that
//! read what it writes, and, where a unit reads what shares memory with something else, back to
//! the units that write that, since it is overwritten by now. Units that only steps run are
//! driven by their steps alone; a step that ran makes its readers run.
//!
//! Marks stay until the unit ran whole. Nothing here knows a device, and deciding allocates
//! nothing.

mod answers;
mod carry;
mod fingerprint;
mod reason;

pub use reason::{Cause, Reason};

use super::model::{ObjectId, ObjectRef, Origin, PassKind, Plan, Unit};
use crate::graph::value::Value;
use reason::{Marks, causes};

/// What has changed since each unit of a plan last ran.
#[derive(Clone, Debug)]
pub struct Changes {
    causes: Vec<Cause>,
    nodes: Vec<Node>,
    /// Words of one row of bits, a bit to a cause.
    words: usize,
    /// Which causes each unit has.
    of: Vec<u64>,
    /// What each unit has yet to run for.
    pending: Decision,
    /// What runs in the frame at hand, and why.
    now: Decision,
    queue: Vec<usize>,
    /// For each cause that frames give, its last value.
    live: Vec<(usize, Option<Value>)>,
    /// Whether each `Steps` ran in the frame before.
    stepped: Vec<bool>,
    /// What each pass is.
    prints: Vec<u128>,
    /// Passes that settle counts for others than under the plan before, and need not run.
    unanswered: Vec<usize>,
}

/// What runs and why: for each unit marks and a row of causes.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Decision {
    runs: Vec<bool>,
    marks: Vec<Marks>,
    changed: Vec<u64>,
}

impl Clone for Decision {
    fn clone(&self) -> Self {
        Self { runs: self.runs.clone(), marks: self.marks.clone(), changed: self.changed.clone() }
    }

    /// Into memory that is there: frames are decided on all the time.
    fn clone_from(&mut self, source: &Self) {
        let Self { runs, marks, changed } = source;
        self.runs.clone_from(runs);
        self.marks.clone_from(marks);
        self.changed.clone_from(changed);
    }
}

#[derive(Clone, Debug, Default)]
struct Node {
    /// The `Steps` that its passes are in.
    steps: Vec<usize>,
    /// It has no pass outside `Steps`.
    only_steps: bool,
    /// It changes what comes from outside, so that it has to run for each frame.
    writes_input: bool,
    touches_state: bool,
    readers: Vec<usize>,
    /// Units that write what this one reads and shares its memory.
    makers: Vec<usize>,
}

impl Changes {
    /// Of a plan that never ran. `shares` says of which objects the memory serves others too.
    pub fn new(plan: &Plan, shares: &dyn Fn(ObjectId) -> bool) -> Self {
        let causes = causes(plan);
        let words = causes.len().div_ceil(64);
        let units = plan.units.len();
        let mut of = vec![0; units * words];
        for (n, cause) in causes.iter().enumerate() {
            for (unit, row) in plan.units.iter().zip(of.chunks_exact_mut(words.max(1))) {
                if cause.is_among(&unit.causes) {
                    row[n / 64] |= 1 << (n % 64);
                }
            }
        }
        let empty = Decision {
            runs: vec![false; units],
            marks: vec![Marks::default(); units],
            changed: vec![0; units * words],
        };
        let nodes = nodes(plan, shares);
        // What steps run for is not what the frame has.
        let outside = |n: usize| nodes.iter().enumerate().any(|(u, node)| !node.only_steps && bit(&of, words, u, n));
        let is_given = |cause: &Cause| matches!(cause, Cause::Live(name) if name != "step");
        let live = (0..causes.len()).filter(|n| is_given(&causes[*n]) && outside(*n)).map(|n| (n, None)).collect();
        let mut changes = Self {
            live,
            causes,
            nodes,
            words,
            of,
            now: empty.clone(),
            pending: empty,
            queue: Vec::with_capacity(units),
            stepped: vec![true; plan.steps.len()],
            prints: fingerprint::passes(plan),
            unanswered: Vec::new(),
        };
        changes.mark_all(&Reason::First);
        changes
    }

    /// Whether the plan says nothing of units: then every pass runs in every frame.
    pub fn is_blind(&self) -> bool {
        self.nodes.is_empty()
    }

    /// How many names there are whose values frames give.
    pub fn live_count(&self) -> usize {
        self.live.len()
    }

    /// One of the names whose values frames give.
    pub fn live_name(&self, at: usize) -> Option<&str> {
        match self.causes.get(self.live.get(at)?.0)? {
            Cause::Live(name) => Some(name),
            _ => None,
        }
    }

    /// Tells the value of one of these names in the frame to come. What has none counts as changed.
    /// Tells whether it is another than before.
    pub fn note_live(&mut self, at: usize, value: Option<Value>) -> bool {
        let (cause, last) = &mut self.live[at];
        let same = matches!((&value, &*last), (Some(a), Some(b)) if is_same(a, b));
        if !same {
            *last = value;
            let cause = *cause;
            self.note(cause);
        }
        !same
    }

    /// The value that was told last of a name.
    pub fn live_value(&self, name: &str) -> Option<&Value> {
        self.live_value_at(self.live_place(name)?)
    }

    /// The same by its place among those that frames give.
    pub fn live_value_at(&self, at: usize) -> Option<&Value> {
        self.live.get(at)?.1.as_ref()
    }

    /// The place of a name among those whose values frames give.
    pub fn live_place(&self, name: &str) -> Option<usize> {
        // Causes of a kind are in the order of their names.
        let place = |(n, _): &(usize, Option<Value>)| match &self.causes[*n] {
            Cause::Live(live) => live.as_str().cmp(name),
            _ => std::cmp::Ordering::Less,
        };
        self.live.binary_search_by(place).ok()
    }

    /// Tells that an input has another content than before.
    pub fn note_input(&mut self, name: &str) {
        let cause = self.causes.iter().position(|cause| matches!(cause, Cause::Input(input) if input == name));
        cause.into_iter().for_each(|cause| self.note(cause));
    }

    /// Tells that all state starts anew.
    pub fn note_reset(&mut self) {
        for (node, marks) in self.nodes.iter().zip(&mut self.pending.marks) {
            if node.touches_state {
                marks.add(&Reason::Reset);
            }
        }
        self.stepped.fill(true);
    }

    /// Tells that what every unit wrote is gone.
    pub fn note_lost(&mut self) {
        self.mark_all(&Reason::Memory);
    }

    /// Tells that the frame could not be finished: nobody knows what it left.
    pub fn failed(&mut self) {
        self.mark_all(&Reason::Unfinished);
        self.stepped.fill(true);
    }

    fn note(&mut self, cause: usize) {
        for unit in 0..self.nodes.len() {
            if bit(&self.of, self.words, unit, cause) {
                self.pending.changed[unit * self.words + cause / 64] |= 1 << (cause % 64);
            }
        }
    }

    fn mark_all(&mut self, reason: &Reason) {
        self.pending.marks.iter_mut().for_each(|marks| marks.add(reason));
    }

    /// Decides what runs in the frame to come; `due` has how many steps each `Steps` runs in it.
    /// With `all` somebody asks for everything; `together` is the smallest policy, under which
    /// everything runs if anything does. Tells whether anything runs.
    pub fn decide(&mut self, due: &[u32], all: bool, together: bool) -> bool {
        let is_due = |steps: &usize| due.get(*steps).is_some_and(|times| *times > 0);
        self.now.marks.copy_from_slice(&self.pending.marks);
        self.now.changed.copy_from_slice(&self.pending.changed);
        self.queue.clear();
        for (unit, node) in self.nodes.iter().enumerate() {
            let marks = &mut self.now.marks[unit];
            let steps = node.steps.iter().any(is_due);
            if node.only_steps {
                // Whatever changed: only its steps make it run.
                *marks = Marks::default();
                self.now.changed[unit * self.words..(unit + 1) * self.words].fill(0);
            } else {
                if all {
                    marks.add(&Reason::Asked);
                }
                if node.writes_input {
                    marks.add(&Reason::WritesInput);
                }
            }
            let stepped = !node.only_steps && node.steps.iter().any(|steps| self.stepped[*steps]);
            if steps || stepped {
                marks.add(&Reason::Step);
            }
            let changed = self.now.changed[unit * self.words..(unit + 1) * self.words].iter().any(|word| *word != 0);
            self.now.runs[unit] = changed || !marks.is_empty();
            if self.now.runs[unit] {
                self.queue.push(unit);
            }
        }
        self.spread();
        let any = self.now.runs.contains(&true);
        if any && together {
            for unit in (0..self.nodes.len()).filter(|unit| !self.nodes[*unit].only_steps) {
                if !std::mem::replace(&mut self.now.runs[unit], true) {
                    self.now.marks[unit].add(&Reason::Together);
                }
            }
        }
        any || self.is_blind()
    }

    /// From what runs on to its readers, and back to those who write what shares memory.
    fn spread(&mut self) {
        while let Some(unit) = self.queue.pop() {
            for (reason, others) in
                [(Reason::Upstream, &self.nodes[unit].readers), (Reason::Shared, &self.nodes[unit].makers)]
            {
                for other in others {
                    if !self.nodes[*other].only_steps && !self.now.runs[*other] {
                        self.now.runs[*other] = true;
                        self.now.marks[*other].add(&reason);
                        self.queue.push(*other);
                    }
                }
            }
        }
    }

    /// Whether a unit runs in the frame at hand.
    pub fn runs(&self, unit: usize) -> bool {
        self.now.runs.get(unit).is_none_or(|runs| *runs)
    }

    /// Tells that the frame ran, of `only` some passes if somebody chose: a unit of which a pass
    /// was left out has yet to run.
    pub fn done(&mut self, plan: &Plan, due: &[u32], only: Option<&[bool]>) {
        for (unit, node) in self.nodes.iter().enumerate() {
            if !self.now.runs[unit] && !node.only_steps {
                continue;
            }
            let is_left_out = |only: &[bool]| plan.units[unit].passes.iter().any(|p| only.get(*p) == Some(&false));
            if only.is_some_and(is_left_out) {
                if self.now.runs[unit] {
                    self.pending.marks[unit].add(&Reason::Unfinished);
                }
                continue;
            }
            self.pending.marks[unit] = Marks::default();
            self.pending.changed[unit * self.words..(unit + 1) * self.words].fill(0);
        }
        for (steps, stepped) in self.stepped.iter_mut().enumerate() {
            *stepped = due.get(steps).is_some_and(|times| *times > 0);
        }
    }

    /// What was decided for the frame at hand.
    pub fn decision(&self) -> &Decision {
        &self.now
    }

    /// Why a unit runs, as a decision says; nothing if it does not.
    pub fn why(&self, decision: &Decision, unit: usize) -> Vec<Reason> {
        if decision.runs.get(unit) != Some(&true) {
            return Vec::new();
        }
        let mut reasons = decision.marks[unit].reasons();
        let of = |n: &usize| bit(&decision.changed, self.words, unit, *n);
        reasons.extend((0..self.causes.len()).filter(of).map(|n| Reason::Cause(self.causes[n].clone())));
        reasons
    }
}

impl Decision {
    /// Whether a unit runs; absent if the plan has no such unit.
    pub fn runs(&self, unit: usize) -> Option<bool> {
        self.runs.get(unit).copied()
    }

    /// How many units were decided on.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }
}

fn bit(rows: &[u64], words: usize, row: usize, n: usize) -> bool {
    rows[row * words + n / 64] & (1 << (n % 64)) != 0
}

/// To the bit, since a shader can tell 0 from -0.
fn is_same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Float(a), Value::Float(b)) => a.to_bits() == b.to_bits(),
        (Value::Vector(a), Value::Vector(b)) => a.has_bits_of(b),
        _ => a == b,
    }
}

/// The objects that a reference can stand for.
fn objects(plan: &Plan, object: &ObjectRef) -> Vec<ObjectId> {
    match object {
        ObjectRef::Fixed(id) => vec![*id],
        ObjectRef::Ring { ring, .. } => plan.rings[*ring].objects.clone(),
    }
}

fn nodes(plan: &Plan, shares: &dyn Fn(ObjectId) -> bool) -> Vec<Node> {
    let mut writer: Vec<Option<usize>> = vec![None; plan.objects.len()];
    for pass in &plan.passes {
        for access in pass.accesses.iter().filter(|a| a.write) {
            objects(plan, &access.object).into_iter().for_each(|id| writer[id] = Some(pass.unit));
        }
    }
    plan.units.iter().enumerate().map(|(u, unit)| node(plan, u, unit, &writer, shares)).collect()
}

fn node(plan: &Plan, u: usize, unit: &Unit, writer: &[Option<usize>], shares: &dyn Fn(ObjectId) -> bool) -> Node {
    let mut node = Node { readers: unit.readers.clone(), only_steps: true, ..Node::default() };
    for pass in unit.passes.iter().map(|p| &plan.passes[*p]) {
        node.only_steps &= pass.steps.is_some();
        node.steps.extend(pass.steps);
        // Settling and making mips again changes nothing.
        let repeats = matches!(pass.kind, PassKind::Settle { .. } | PassKind::Mips { .. });
        for access in &pass.accesses {
            for id in objects(plan, &access.object) {
                match plan.objects[id].origin {
                    Origin::State(_) => node.touches_state = true,
                    Origin::Input(_) | Origin::Attribute { .. } | Origin::Mesh { .. } => {
                        node.writes_input |= access.write && !repeats
                    }
                    Origin::Frame => {}
                }
                if access.read && shares(id) {
                    node.makers.extend(writer[id].filter(|maker| *maker != u));
                }
            }
        }
    }
    node.steps.sort_unstable();
    node.steps.dedup();
    node.makers.sort_unstable();
    node.makers.dedup();
    node
}
