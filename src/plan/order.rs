//! The order in which passes run, and clears that become the load of a target.
//!
//! Program order says which write a read sees; among passes that touch nothing in common it says
//! nothing. Those are brought together so that dispatches share a compute pass and draws into
//! the same targets a render pass: fewer passes of the device, and fewer barriers between them.
//! What reads, writes or makes arguments for each other stays in order, and nothing crosses the
//! edge of `Steps`. An order that needs more memory at once is not taken.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Range;

use super::lower::{FlatPass, Lowering};
use super::memory;
use super::model::{Folded, Moved, ObjectId, ObjectKind, ObjectRef, Order, PassKind, View};

/// By how many parts of itself the largest live set may grow for fewer passes of the device.
const GROWTH: u64 = 32;

/// Folds clears and orders the passes; says what it did.
pub(super) fn order(lowering: &mut Lowering<'_>, own: &BTreeSet<ObjectId>) -> Order {
    let folded = fold_clears(lowering);
    let moved = group(lowering, own);
    Order { folded, moved }
}

/// A clear of what the next pass that touches it draws into becomes the load of that target.
fn fold_clears(lowering: &mut Lowering<'_>) -> Vec<Folded> {
    let mut folded = Vec::new();
    let mut gone = BTreeSet::new();
    let clears: Vec<usize> = (0..lowering.flat.len()).filter(|p| cleared(lowering, *p).is_some()).collect();
    if clears.is_empty() {
        return folded;
    }
    let touching = touching(lowering);
    for at in clears {
        let Some(draw) = drawn_next(lowering, &touching, at) else { continue };
        let PassKind::Clear { value, .. } = lowering.flat[at].pass.kind else { continue };
        let clear = lowering.flat[at].clone();
        if !load(&mut lowering.flat[draw], &clear, value) {
            continue;
        }
        folded.push(Folded { clear: clear.pass.path.clone(), into: lowering.flat[draw].pass.path.clone() });
        gone.insert(at);
    }
    if !gone.is_empty() {
        let mut at = 0..;
        lowering.flat.retain(|_| at.next().is_some_and(|at| !gone.contains(&at)));
        super::insert::cover_steps(lowering);
    }
    folded
}

/// The texture of which a pass clears one mip and layer.
fn cleared(lowering: &Lowering<'_>, at: usize) -> Option<ObjectId> {
    let PassKind::Clear { view, .. } = &lowering.flat[at].pass.kind else { return None };
    let ObjectRef::Fixed(id) = view.object else { return None };
    let ObjectKind::Texture(texture) = &lowering.objects[id].object.kind else { return None };
    (!texture.is_3d && view.mips.len() == 1 && view.layers.len() == 1).then_some(id)
}

/// For each object the passes that touch it.
fn touching(lowering: &Lowering<'_>) -> Vec<Vec<usize>> {
    let mut touching: Vec<Vec<usize>> = vec![Vec::new(); lowering.objects.len()];
    for (p, flat) in lowering.flat.iter().enumerate() {
        for id in flat.pass.accesses.iter().flat_map(|a| ids(lowering, &a.object)) {
            touching[*id].push(p);
        }
    }
    touching
}

/// Every object that a reference can stand for.
fn ids<'a>(lowering: &'a Lowering<'_>, object: &'a ObjectRef) -> &'a [ObjectId] {
    match object {
        ObjectRef::Fixed(id) => std::slice::from_ref(id),
        ObjectRef::Ring { ring, .. } => &lowering.rings[*ring].objects,
    }
}

/// The next pass that touches what a pass clears, in the same steps.
fn drawn_next(lowering: &Lowering<'_>, touching: &[Vec<usize>], at: usize) -> Option<usize> {
    let next = *touching[cleared(lowering, at)?].iter().find(|p| **p > at)?;
    let same_steps = (at..=next).all(|p| lowering.flat[p].pass.steps == lowering.flat[at].pass.steps);
    same_steps.then_some(next)
}

/// Makes a clear the load of the target that it cleared, if the draw has it and loads it.
fn load(draw: &mut FlatPass, clear: &FlatPass, value: [f64; 4]) -> bool {
    let PassKind::Clear { view, .. } = &clear.pass.kind else { return false };
    let PassKind::Draw(drawn) = &mut draw.pass.kind else { return false };
    let is_it =
        |target: &View| target.object == view.object && target.mips == view.mips && target.layers == view.layers;
    let touching = draw.pass.accesses.iter().filter(|a| a.object == view.object).count();
    if touching != 1 {
        return false;
    }
    let color = drawn.color.iter_mut().find(|t| is_it(&t.view) && t.clear.is_none());
    let depth = drawn
        .depth
        .as_mut()
        .filter(|d| is_it(&d.view) && d.clear.is_none() && d.write && !d.format.has_stencil_aspect());
    if let Some(target) = color {
        target.clear = Some(value);
    } else if let Some(target) = depth {
        target.clear = Some(value[0] as f32);
    } else {
        return false;
    }
    for access in draw.pass.accesses.iter_mut().filter(|a| a.object == view.object) {
        (access.read, access.write, access.whole) = (false, true, true);
    }
    draw.causes.add(&clear.causes);
    true
}

/// What passes have to be alike in to share one of the device's.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Class {
    Dispatch,
    Draw(Vec<(ObjectRef, u32, u32)>),
    /// Copies and clears, each by itself.
    Transfer,
}

/// Brings passes together that may share one of the device's.
fn group(lowering: &mut Lowering<'_>, own: &BTreeSet<ObjectId>) -> Vec<Moved> {
    let classes: Vec<Class> = lowering.flat.iter().map(|flat| class(lowering, &flat.pass.kind)).collect();
    let before = dependencies(lowering);
    let mut order = Vec::with_capacity(classes.len());
    for segment in segments(lowering) {
        order.extend(schedule(&classes, &before, segment));
    }
    let program: Vec<usize> = (0..classes.len()).collect();
    let is_worth_it = order != program
        && passes_of_device(&classes, &order) < passes_of_device(&classes, &program)
        && grows_little(live_bytes(lowering, &program, own), live_bytes(lowering, &order, own));
    if !is_worth_it {
        return Vec::new();
    }
    let mut flat: Vec<Option<FlatPass>> = std::mem::take(&mut lowering.flat).into_iter().map(Some).collect();
    lowering.flat = order.iter().filter_map(|p| flat[*p].take()).collect();
    moved(&order)
}

fn grows_little(before: u64, now: u64) -> bool {
    now <= before + before / GROWTH
}

fn class(lowering: &Lowering<'_>, kind: &PassKind) -> Class {
    match kind {
        PassKind::Compute { .. } | PassKind::Settle { .. } => Class::Dispatch,
        PassKind::Clear { view, value } => match &lowering.object(view.object).object.kind {
            ObjectKind::Buffer(_) if value[0] != 0.0 => Class::Dispatch,
            _ => Class::Transfer,
        },
        PassKind::Draw(draw) => {
            let views = draw.color.iter().map(|t| &t.view).chain(draw.depth.iter().map(|d| &d.view));
            Class::Draw(views.map(|v| (v.object, v.mips.start, v.layers.start)).collect())
        }
        PassKind::Copy { .. } | PassKind::Mips { .. } | PassKind::Arguments { .. } => Class::Transfer,
    }
}

/// Runs of passes of the same `Steps`, or of none.
fn segments(lowering: &Lowering<'_>) -> Vec<Range<usize>> {
    let mut segments: Vec<Range<usize>> = Vec::new();
    for (p, flat) in lowering.flat.iter().enumerate() {
        match segments.last_mut() {
            Some(last) if lowering.flat[last.start].pass.steps == flat.pass.steps => last.end = p + 1,
            _ => segments.push(p..p + 1),
        }
    }
    segments
}

/// For each pass those that must run before it.
fn dependencies(lowering: &Lowering<'_>) -> Vec<Vec<usize>> {
    let mut writer: Vec<Option<usize>> = vec![None; lowering.objects.len()];
    let mut readers: Vec<Vec<usize>> = vec![Vec::new(); lowering.objects.len()];
    let mut slots: HashMap<u32, usize> = HashMap::new();
    let mut before: Vec<Vec<usize>> = Vec::with_capacity(lowering.flat.len());
    for (p, flat) in lowering.flat.iter().enumerate() {
        let mut needs: Vec<usize> = Vec::new();
        for access in &flat.pass.accesses {
            for id in ids(lowering, &access.object).iter().copied() {
                needs.extend(writer[id].filter(|w| *w != p));
                if access.write {
                    needs.extend(readers[id].iter().filter(|r| **r != p));
                }
            }
        }
        for access in &flat.pass.accesses {
            for id in ids(lowering, &access.object).iter().copied() {
                if access.write {
                    writer[id] = Some(p);
                    readers[id].clear();
                }
                if access.read || !access.write {
                    readers[id].push(p);
                }
            }
        }
        match &flat.pass.kind {
            PassKind::Settle { arguments, .. } => slots.extend(arguments.iter().map(|a| (a.slot, p))),
            PassKind::Arguments { slot, .. } => _ = slots.insert(*slot, p),
            kind => needs.extend(kind.slot().and_then(|slot| slots.get(&slot))),
        }
        needs.sort_unstable();
        needs.dedup();
        before.push(needs);
    }
    before
}

/// An order of a segment that stays with one class for as long as it can, and else takes what
/// comes first in the program.
fn schedule(classes: &[Class], before: &[Vec<usize>], segment: Range<usize>) -> Vec<usize> {
    let mut waits: Vec<usize> =
        segment.clone().map(|p| before[p].iter().filter(|b| segment.contains(b)).count()).collect();
    let mut after: Vec<Vec<usize>> = vec![Vec::new(); segment.len()];
    for p in segment.clone() {
        for b in before[p].iter().filter(|b| segment.contains(b)) {
            after[b - segment.start].push(p);
        }
    }
    let mut ready: BTreeSet<usize> = segment.clone().filter(|p| waits[p - segment.start] == 0).collect();
    let mut of_class: BTreeMap<&Class, BTreeSet<usize>> = BTreeMap::new();
    for p in &ready {
        of_class.entry(&classes[*p]).or_default().insert(*p);
    }
    let mut order: Vec<usize> = Vec::with_capacity(segment.len());
    while let Some(first) = ready.first().copied() {
        let alike = order.last().and_then(|last| of_class.get(&classes[*last])?.first().copied());
        let p = alike.unwrap_or(first);
        ready.remove(&p);
        if let Some(same) = of_class.get_mut(&classes[p]) {
            same.remove(&p);
        }
        order.push(p);
        for next in &after[p - segment.start] {
            waits[next - segment.start] -= 1;
            if waits[next - segment.start] == 0 {
                ready.insert(*next);
                of_class.entry(&classes[*next]).or_default().insert(*next);
            }
        }
    }
    order
}

/// How many passes of the device an order takes, about.
fn passes_of_device(classes: &[Class], order: &[usize]) -> usize {
    let parted =
        order.windows(2).filter(|pair| classes[pair[0]] != classes[pair[1]] || classes[pair[0]] == Class::Transfer);
    parted.count() + 1
}

/// Bytes of the largest set that is live at once in an order.
fn live_bytes(lowering: &Lowering<'_>, order: &[usize], own: &BTreeSet<ObjectId>) -> u64 {
    let objects: Vec<_> = lowering.objects.iter().map(|b| &b.object).collect();
    let touched = |p: usize| lowering.flat[p].pass.accesses.iter().map(|a| ids(lowering, &a.object)).collect();
    memory::live_at_once(&objects, order, touched, &lowering.steps, own)
}

/// Which passes now run before ones that the program has before them.
fn moved(order: &[usize]) -> Vec<Moved> {
    // The least of those behind each place.
    let mut least = vec![usize::MAX; order.len() + 1];
    for at in (0..order.len()).rev() {
        least[at] = least[at + 1].min(order[at]);
    }
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(at, p)| place[*p] = at);
    let mut moved: Vec<Moved> = Vec::new();
    for (at, p) in order.iter().enumerate() {
        let passed = least[at + 1];
        if passed > *p {
            continue;
        }
        let before = place[passed];
        match moved.last_mut() {
            Some(last) if last.passes.end == at && last.before == before => last.passes.end = at + 1,
            _ => moved.push(Moved { passes: at..at + 1, before }),
        }
    }
    moved
}
