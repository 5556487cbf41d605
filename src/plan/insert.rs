//! The engine's own passes: settling counts, making mips, copying arguments.

use std::collections::{BTreeSet, HashMap};

use super::lower::{FlatPass, Lowering, Place};
use super::model::{Access, Argument, ArgumentKind, ObjectId, ObjectKind, ObjectRef, Pass, PassKind};

/// What has to be made before the next reader.
#[derive(Clone, Default)]
struct Pending {
    /// Counted buffers whose count changed since they were settled.
    unsettled: BTreeSet<ObjectId>,
    /// Textures whose mip 0 changed since their mips were made.
    stale: BTreeSet<ObjectId>,
}

impl Pending {
    fn add(&mut self, other: &Pending) {
        self.unsettled.extend(&other.unsettled);
        self.stale.extend(&other.stale);
    }
}

struct Inserter {
    out: Vec<FlatPass>,
    pending: Pending,
    /// The `Steps` being walked, and what was pending before it.
    before_steps: Option<(usize, Pending)>,
    slots: u32,
    /// Where each counted buffer was last settled, as an index into `out`.
    settled: HashMap<ObjectRef, usize>,
}

/// Puts the engine's passes into the flat list; gives the number of argument slots.
pub(super) fn insert(lowering: &mut Lowering<'_>) -> u32 {
    let changed = changed_in_steps(lowering);
    let mut inserter = Inserter {
        out: Vec::new(),
        pending: Pending::default(),
        before_steps: None,
        slots: 0,
        settled: HashMap::new(),
    };
    // A count from an earlier frame, or from outside, was not settled in this one.
    inserter.pending.unsettled =
        (0..lowering.objects.len()).filter(|id| is_counted(lowering, ObjectRef::Fixed(*id))).collect();
    for mut flat in std::mem::take(&mut lowering.flat) {
        inserter.around_steps(flat.pass.steps, &changed);
        inserter.settle_before(lowering, &mut flat);
        inserter.mips_before(lowering, &flat);
        inserter.arguments_before(&mut flat);
        mark_changed(lowering, &flat, &mut inserter.pending, |object| vec![lowering.object_id(object)]);
        inserter.out.push(flat);
    }
    lowering.flat = inserter.out;
    inserter.slots
}

/// What the passes of each `Steps` change; of a ring that turns, every member.
fn changed_in_steps(lowering: &Lowering<'_>) -> Vec<Pending> {
    let mut changed = vec![Pending::default(); lowering.steps.len()];
    for flat in &lowering.flat {
        if let Some(steps) = flat.pass.steps {
            mark_changed(lowering, flat, &mut changed[steps], |object| lowering.object_ids(object).collect());
        }
    }
    changed
}

fn mark_changed(
    lowering: &Lowering<'_>,
    flat: &FlatPass,
    pending: &mut Pending,
    ids: impl Fn(ObjectRef) -> Vec<ObjectId>,
) {
    for (access, place) in flat.pass.accesses.iter().zip(&flat.places) {
        if place.appends && is_counted(lowering, access.object) {
            pending.unsettled.extend(ids(access.object));
        }
        if access.write && lowering.object(access.object).mips_auto {
            pending.stale.extend(ids(access.object));
        }
    }
}

impl Inserter {
    /// A step may follow another, and a frame may run no step: what steps change counts as
    /// changed where they begin, and what was to be made before them still is after them.
    fn around_steps(&mut self, now: Option<usize>, changed: &[Pending]) {
        if let Some((open, saved)) = &self.before_steps
            && now != Some(*open)
        {
            self.pending.add(saved);
            // Arguments were written inside; a consumer behind needs its own even if no step runs.
            self.pending.unsettled.extend(&changed[*open].unsettled);
            self.before_steps = None;
        }
        if let (None, Some(steps)) = (&self.before_steps, now) {
            self.before_steps = Some((steps, self.pending.clone()));
            self.pending.add(&changed[steps]);
        }
    }

    /// Settles every counted buffer that the pass reads, and gives it its slots.
    fn settle_before(&mut self, lowering: &Lowering<'_>, flat: &mut FlatPass) {
        let reads: Vec<ObjectRef> = flat
            .pass
            .accesses
            .iter()
            .zip(&flat.places)
            .filter(|(access, place)| access.read && !place.appends && is_counted(lowering, access.object))
            .map(|(access, _)| access.object)
            .chain(flat.counted.iter().map(|(object, _)| *object))
            .collect();
        for object in reads {
            if self.pending.unsettled.remove(&lowering.object_id(object)) {
                let kind = PassKind::Settle { counted: object, arguments: Vec::new() };
                self.settled.insert(object, self.out.len());
                self.out.push(made(lowering, flat, "settle", object, kind));
            }
        }
        for (object, kind) in flat.counted.clone() {
            let slot = self.slots;
            self.slots += 1;
            flat.pass.kind.slot_mut().into_iter().for_each(|place| *place = slot);
            let settle = self.settled.get(&object).map(|at| &mut self.out[*at].pass.kind);
            if let Some(PassKind::Settle { arguments, .. }) = settle {
                arguments.push(Argument { slot, kind });
            }
        }
    }

    fn mips_before(&mut self, lowering: &Lowering<'_>, flat: &FlatPass) {
        for (access, place) in flat.pass.accesses.iter().zip(&flat.places) {
            if place.samples_mips && self.pending.stale.remove(&lowering.object_id(access.object)) {
                let kind = PassKind::Mips { texture: access.object };
                self.out.push(made(lowering, flat, "mips", access.object, kind));
            }
        }
    }

    /// A draw with arguments that a shader wrote gets a copy of them.
    fn arguments_before(&mut self, flat: &mut FlatPass) {
        let Some((from, offset, indexed)) = flat.arguments else { return };
        let slot = self.slots;
        self.slots += 1;
        flat.pass.kind.slot_mut().into_iter().for_each(|place| *place = slot);
        let access = Access { object: from, mips: 0..1, layers: 0..1, read: true, write: false, whole: false };
        let pass = Pass {
            path: format!("{} (arguments)", flat.pass.path),
            span: flat.pass.span,
            unit: 0,
            steps: flat.pass.steps,
            kind: PassKind::Arguments { from, offset, indexed, slot },
            accesses: vec![access],
            unordered: false,
        };
        let places =
            vec![Place { graph: flat.word, shader: None, name: "".into(), samples_mips: false, appends: false }];
        self.out.push(FlatPass {
            pass,
            causes: flat.causes.clone(),
            word: flat.word,
            trace: flat.trace.clone(),
            counted: Vec::new(),
            arguments: None,
            places,
        });
    }
}

fn is_counted(lowering: &Lowering<'_>, object: ObjectRef) -> bool {
    matches!(&lowering.object(object).object.kind, ObjectKind::Buffer(b) if b.counted)
}

/// A pass of the engine before `reader`, that reads and writes one object.
fn made(lowering: &Lowering<'_>, reader: &FlatPass, what: &str, object: ObjectRef, kind: PassKind) -> FlatPass {
    let building = lowering.object(object);
    let (mips, layers) = match &building.object.kind {
        ObjectKind::Texture(t) => (t.mips, if t.is_3d { 1 } else { t.layers }),
        ObjectKind::Buffer(_) => (1, 1),
    };
    let access = Access { object, mips: 0..mips, layers: 0..layers, read: true, write: true, whole: false };
    let place = Place {
        graph: reader.word,
        shader: None,
        name: building.object.path.as_str().into(),
        samples_mips: false,
        appends: false,
    };
    FlatPass {
        pass: Pass {
            path: format!("{} ({what})", building.object.path),
            span: building.object.span,
            unit: 0,
            steps: reader.pass.steps,
            kind,
            accesses: vec![access],
            unordered: false,
        },
        // Of an input, its version.
        causes: building.causes.clone(),
        word: reader.word,
        trace: reader.trace.clone(),
        counted: Vec::new(),
        arguments: None,
        places: vec![place],
    }
}

/// Steps cover the passes that came to lie in them.
pub(super) fn cover_steps(lowering: &mut Lowering<'_>) {
    for steps in &mut lowering.steps {
        steps.passes = 0..0;
    }
    for (p, flat) in lowering.flat.iter().enumerate() {
        let Some(steps) = flat.pass.steps.map(|index| &mut lowering.steps[index].passes) else { continue };
        *steps = if steps.end == 0 { p } else { steps.start }..p + 1;
    }
}

/// The kind of arguments, for printing.
pub(super) fn describe(kind: &ArgumentKind) -> String {
    match kind {
        ArgumentKind::Dispatch { threads } => format!("dispatch of {threads} threads a group"),
        ArgumentKind::Draw { vertices, instances, indexed } => {
            let n = |x: &Option<u32>| x.map_or("n".to_owned(), |x| x.to_string());
            let what = if *indexed { "indices" } else { "vertices" };
            format!("draw of {} {what}, {} instances", n(vertices), n(instances))
        }
    }
}
