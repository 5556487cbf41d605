//! Lifetimes, and which objects may share memory (rule 38).

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap, HashMap};

use wgpu_types::TextureUsages;

use super::model::{Apart, Memory, Object, ObjectId, ObjectKind, Origin, Slot, Steps, Texture, Unit};
use crate::format;

/// The bytes of an object as this program counts them: what its texels or items take.
pub fn bytes(kind: &ObjectKind) -> u64 {
    match kind {
        ObjectKind::Buffer(buffer) => buffer.bytes(),
        ObjectKind::Texture(t) => (0..t.mips).map(|mip| mip_bytes(t, mip)).sum(),
    }
}

fn mip_bytes(t: &Texture, mip: u32) -> u64 {
    let edge = |n: u32| u64::from((n >> mip).max(1));
    let layers = if t.is_3d { edge(t.layers) } else { u64::from(t.layers) };
    let texel = u64::from(t.format.block_copy_size(None).unwrap_or_else(|| format::channels(t.format) * 4));
    edge(t.width) * edge(t.height) * layers * texel * u64::from(t.samples)
}

/// Fills in lifetimes. `touched` has the objects of each pass.
pub(super) fn lifetimes(objects: &mut [Object], touched: &[Vec<ObjectId>], steps: &[Steps]) {
    for (p, ids) in touched.iter().enumerate() {
        for id in ids {
            let lifetime = &mut objects[*id].lifetime;
            *lifetime = Some(lifetime.map_or((p, p), |(first, _)| (first, p)));
        }
    }
    for object in objects {
        let Some((first, last)) = &mut object.lifetime else { continue };
        // What lives into a loop of steps lives to its end: the next step reads it again.
        for steps in steps {
            if *first < steps.passes.start && steps.passes.contains(last) {
                *last = steps.passes.end - 1;
            }
        }
    }
}

/// Which objects share memory where the frame stays whole. `runs` and `touched` have when each pass runs
/// and its objects; `own` are outputs and what somebody looks at.
pub(super) fn share(
    objects: &[Object],
    runs: &[Runs],
    touched: &[Vec<ObjectId>],
    units: &[Unit],
    own: &BTreeSet<ObjectId>,
) -> Memory {
    let mut apart = apart(runs, touched, units);
    apart.retain(|id, _| objects[*id].origin == Origin::Frame);
    apart.extend(own.iter().map(|id| (*id, Apart::LookedAt)));
    let lives = lives(objects, runs.len(), &|id| own.contains(&id));
    let keep = slots(objects, &lives, &|id| !apart.contains_key(&id));
    let mut share = slots(objects, &lives, &|_| true);
    // More freedom may lead a greedy choice astray; what may be kept is good enough for both then.
    if total(&share) > total(&keep) {
        share.clone_from(&keep);
    }
    let (largest_at, lower_bound) = largest(&lives);
    Memory {
        keep,
        share,
        apart,
        unshared: lives.iter().map(|life| life.bytes).sum(),
        lower_bound,
        largest_at,
        alike_bound: alike_bound(objects, &lives),
        outside: objects.iter().filter(|o| o.origin != Origin::Frame).map(|o| bytes(&o.kind)).sum(),
        ..Memory::default()
    }
}

/// From which pass to which an object has to have memory.
#[derive(Clone, Copy)]
pub(super) struct Life {
    pub id: ObjectId,
    pub first: usize,
    pub last: usize,
    pub bytes: u64,
}

/// The objects of the frame that have memory, in order of first use. What is looked at after the
/// frame lives to its end, and is there until the next.
pub(super) fn lives(objects: &[Object], passes: usize, is_looked_at: &dyn Fn(ObjectId) -> bool) -> Vec<Life> {
    let life = |(id, object): (ObjectId, &Object)| {
        let (first, last) = object.lifetime.filter(|_| object.origin == Origin::Frame)?;
        let last = if is_looked_at(id) { passes.saturating_sub(1) } else { last };
        Some(Life { id, first, last, bytes: bytes(&object.kind) })
    };
    let mut lives: Vec<Life> = objects.iter().enumerate().filter_map(life).collect();
    lives.sort_by_key(|life| (objects[life.id].lifetime, life.id));
    lives
}

/// Bytes of all slots together.
pub fn total(slots: &[Slot]) -> u64 {
    slots.iter().map(|slot| slot.bytes).sum()
}

/// When a pass runs: its unit, and its `Steps`.
pub(super) type Runs = (usize, Option<usize>);

/// Objects that not all units which touch them run for the same causes. What steps wrote and others
/// read cannot be made again where a frame is only drawn anew, which runs no step.
fn apart(runs: &[Runs], touched: &[Vec<ObjectId>], units: &[Unit]) -> BTreeMap<ObjectId, Apart> {
    let mut first: HashMap<ObjectId, Runs> = HashMap::new();
    let mut apart = BTreeMap::new();
    for ((now, steps), ids) in runs.iter().zip(touched) {
        for id in ids {
            let (unit, first_steps) = *first.entry(*id).or_insert((*now, *steps));
            if first_steps != *steps {
                apart.entry(*id).or_insert(Apart::Steps);
            } else if unit != *now && units[unit].causes != units[*now].causes {
                apart.entry(*id).or_insert(Apart::Causes { units: [unit, *now] });
            }
        }
    }
    apart
}

/// Gives every object a slot, in the order given, that of first use: a free one of its class (the smallest that
/// is large enough, else the largest), else a new one.
fn slots(objects: &[Object], lives: &[Life], may: &dyn Fn(ObjectId) -> bool) -> Vec<Slot> {
    let mut slots: Vec<Slot> = Vec::new();
    // Slots in use by the pass at which they become free; free ones by class and size.
    let mut busy: BinaryHeap<Reverse<(usize, usize)>> = BinaryHeap::new();
    let mut free: HashMap<Option<Texture>, BTreeSet<(u64, usize)>> = HashMap::new();
    for &Life { id, first, last, bytes: size } in lives {
        if !may(id) {
            slots.push(Slot { objects: vec![id], bytes: size });
            continue;
        }
        while let Some(Reverse((_, slot))) = busy.peek().copied().filter(|Reverse((end, _))| *end < first) {
            busy.pop();
            let of = class(&objects[slots[slot].objects[0]].kind);
            free.entry(of).or_default().insert((slots[slot].bytes, slot));
        }
        let found = free.get_mut(&class(&objects[id].kind)).and_then(|free| {
            let found = free.range((size, 0)..).next().or_else(|| free.last()).copied()?;
            free.remove(&found);
            Some(found.1)
        });
        let slot = found.unwrap_or_else(|| {
            slots.push(Slot { objects: Vec::new(), bytes: 0 });
            slots.len() - 1
        });
        slots[slot].objects.push(id);
        slots[slot].bytes = slots[slot].bytes.max(size);
        busy.push(Reverse((last, slot)));
    }
    slots
}

/// Textures share if they are described alike, buffers always: a slot is as large as its largest.
pub(super) fn class(kind: &ObjectKind) -> Option<Texture> {
    match kind {
        ObjectKind::Texture(texture) => Some(Texture { usages: TextureUsages::empty(), ..texture.clone() }),
        ObjectKind::Buffer(_) => None,
    }
}

/// Bytes of the largest set of objects of the frame that is live at once, if passes touch in this
/// order what `touched` has of each.
pub(super) fn live_at_once<'a>(
    objects: &[&Object],
    order: &[usize],
    touched: impl Fn(usize) -> Vec<&'a [ObjectId]>,
    steps: &[Steps],
    own: &BTreeSet<ObjectId>,
) -> u64 {
    let mut lives: Vec<Option<(usize, usize)>> = vec![None; objects.len()];
    for (at, pass) in order.iter().enumerate() {
        for id in touched(*pass).into_iter().flatten() {
            lives[*id] = Some(lives[*id].map_or((at, at), |(first, _)| (first, at)));
        }
    }
    let mut change = vec![0i64; order.len() + 1];
    for (id, (object, life)) in objects.iter().zip(lives).enumerate() {
        let Some((first, last)) = life.filter(|_| object.origin == Origin::Frame) else { continue };
        let inside = steps.iter().find(|s| first < s.passes.start && s.passes.contains(&last));
        let end = inside.map_or(last + 1, |steps| steps.passes.end);
        let size = bytes(&object.kind) as i64;
        change[first] += size;
        change[if own.contains(&id) { order.len() } else { end }] -= size;
    }
    let live = change.iter().scan(0, |live, c| {
        *live += c;
        Some(*live)
    });
    live.max().unwrap_or(0).max(0) as u64
}

/// The first pass at which the most bytes are live, and how many.
fn largest(lives: &[Life]) -> (usize, u64) {
    // Bytes that begin and end at each pass; a running sum is the live set. What ends comes first.
    let begins = |life: &Life| [(life.first, life.bytes as i64), (life.last + 1, -(life.bytes as i64))];
    let mut changes: Vec<(usize, i64)> = lives.iter().flat_map(begins).collect();
    changes.sort_unstable();
    let (mut at, mut most, mut live) = (0, 0, 0);
    for (pass, change) in changes {
        live += change;
        if live > most {
            (at, most) = (pass, live);
        }
    }
    (at, most.max(0) as u64)
}

/// Bytes of the largest live sets of those that can share, one class after another.
fn alike_bound(objects: &[Object], lives: &[Life]) -> u64 {
    let mut classes: HashMap<Option<Texture>, Vec<Life>> = HashMap::new();
    for life in lives {
        classes.entry(class(&objects[life.id].kind)).or_default().push(*life);
    }
    classes.values().map(|alike| largest(alike).1).sum()
}
