//! The engine's own passes: settling counts, making mips, copying arguments.

use std::collections::BTreeSet;

use super::lower::{FlatPass, Lowering, Place};
use super::model::{
    Access, Argument, ArgumentKind, Causes, Dispatch, Geometry, ObjectId, ObjectKind, ObjectRef, Pass, PassKind,
};

/// What has to be made before the next reader.
#[derive(Clone, Default)]
struct Pending {
    /// Counted buffers whose count changed since they were settled.
    unsettled: BTreeSet<ObjectId>,
    /// Textures whose mip 0 changed since their mips were made.
    stale: BTreeSet<ObjectId>,
}

/// Puts the engine's passes into the flat list; gives the number of argument slots.
pub(super) fn insert(lowering: &mut Lowering<'_>) -> u32 {
    let mut out: Vec<FlatPass> = Vec::new();
    let mut slots = 0;
    let mut pending = Pending::default();
    // A count from an earlier frame, or from outside, was not settled in this one.
    for (id, building) in lowering.objects.iter().enumerate() {
        if matches!(&building.object.kind, ObjectKind::Buffer(b) if b.counted) {
            pending.unsettled.insert(id);
        }
    }
    let mut before_steps: Option<(usize, Pending)> = None;
    for mut flat in std::mem::take(&mut lowering.flat) {
        // A frame may run no step: what steps made must be made again after them.
        if let Some((open, saved)) = &before_steps
            && flat.pass.steps != Some(*open)
        {
            pending.unsettled.extend(&saved.unsettled);
            pending.stale.extend(&saved.stale);
            before_steps = None;
        }
        if let (None, Some(steps)) = (&before_steps, flat.pass.steps) {
            before_steps = Some((steps, pending.clone()));
        }
        settle_before(lowering, &mut flat, &mut pending, &mut out, &mut slots);
        mips_before(lowering, &flat, &mut pending, &mut out);
        arguments_before(&mut flat, &mut out, &mut slots);
        for (access, place) in flat.pass.accesses.iter().zip(&flat.places) {
            let id = lowering.object_id(access.object);
            if place.appends {
                pending.unsettled.insert(id);
            }
            if access.write && lowering.objects[id].mips_auto {
                pending.stale.insert(id);
            }
        }
        out.push(flat);
    }
    lowering.flat = out;
    slots
}

/// Settles every counted buffer that the pass reads, and gives it its slots.
fn settle_before(
    lowering: &Lowering<'_>,
    flat: &mut FlatPass,
    pending: &mut Pending,
    out: &mut Vec<FlatPass>,
    slots: &mut u32,
) {
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
        if pending.unsettled.remove(&lowering.object_id(object)) {
            let kind = PassKind::Settle { counted: object, arguments: Vec::new() };
            out.push(made(lowering, flat, "settle", object, kind));
        }
    }
    for (object, kind) in flat.counted.clone() {
        let slot = *slots;
        *slots += 1;
        set_slot(&mut flat.pass.kind, slot);
        let settle = out.iter_mut().rev().find_map(|f| match &mut f.pass.kind {
            PassKind::Settle { counted, arguments } if *counted == object => Some(arguments),
            _ => None,
        });
        if let Some(arguments) = settle {
            arguments.push(Argument { slot, kind });
        }
    }
}

fn is_counted(lowering: &Lowering<'_>, object: ObjectRef) -> bool {
    matches!(&lowering.object(object).object.kind, ObjectKind::Buffer(b) if b.counted)
}

fn mips_before(lowering: &Lowering<'_>, flat: &FlatPass, pending: &mut Pending, out: &mut Vec<FlatPass>) {
    for (access, place) in flat.pass.accesses.iter().zip(&flat.places) {
        if place.samples_mips && pending.stale.remove(&lowering.object_id(access.object)) {
            out.push(made(lowering, flat, "mips", access.object, PassKind::Mips { texture: access.object }));
        }
    }
}

fn arguments_before(flat: &mut FlatPass, out: &mut Vec<FlatPass>, slots: &mut u32) {
    let Some((from, offset, indexed)) = flat.arguments else { return };
    let slot = *slots;
    *slots += 1;
    set_slot(&mut flat.pass.kind, slot);
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
        vec![Place { graph: flat.word, shader: None, name: String::new(), samples_mips: false, appends: false }];
    out.push(FlatPass {
        pass,
        causes: flat.causes.clone(),
        word: flat.word,
        trace: flat.trace.clone(),
        counted: Vec::new(),
        arguments: None,
        places,
    });
}

fn set_slot(kind: &mut PassKind, new: u32) {
    match kind {
        PassKind::Compute { dispatch: Dispatch::Indirect { slot }, .. } => *slot = new,
        PassKind::Draw(draw) => {
            if let Geometry::Indirect { slot, .. } = &mut draw.geometry {
                *slot = new;
            }
        }
        _ => {}
    }
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
        name: building.object.path.clone(),
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
        causes: Causes::default(),
        word: reader.word,
        trace: reader.trace.clone(),
        counted: Vec::new(),
        arguments: None,
        places: vec![place],
    }
}

/// Steps cover the passes that came to lie in them.
pub(super) fn cover_steps(lowering: &mut Lowering<'_>) {
    for (index, steps) in lowering.steps.iter_mut().enumerate() {
        let inside = |f: &FlatPass| f.pass.steps == Some(index);
        let first = lowering.flat.iter().position(inside);
        let last = lowering.flat.iter().rposition(inside);
        steps.passes = match (first, last) {
            (Some(first), Some(last)) => first..last + 1,
            _ => 0..0,
        };
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
