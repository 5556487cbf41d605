//! Lifetimes, and which objects may share memory (rule 38).

use super::model::{Buffer, Memory, Object, ObjectId, ObjectKind, Origin, Pass, Slot, Steps, Texture, Unit};
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

/// Fills in lifetimes.
pub(super) fn lifetimes(
    objects: &mut [Object],
    passes: &[Pass],
    steps: &[Steps],
    ids: &dyn Fn(&Pass) -> Vec<ObjectId>,
) {
    for (p, pass) in passes.iter().enumerate() {
        for id in ids(pass) {
            let lifetime = &mut objects[id].lifetime;
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

/// Which objects share memory under both policies. `own` are those that somebody looks at.
pub(super) fn share(
    objects: &[Object],
    passes: &[Pass],
    units: &[Unit],
    own: &[ObjectId],
    ids: &dyn Fn(&Pass) -> Vec<ObjectId>,
) -> Memory {
    let of_frame: Vec<ObjectId> = (0..objects.len())
        .filter(|id| objects[*id].origin == Origin::Frame && objects[*id].lifetime.is_some())
        .collect();
    let same_causes = |id: ObjectId| {
        let mut causes = passes.iter().filter(|pass| ids(pass).contains(&id)).map(|pass| &units[pass.unit].causes);
        causes.next().is_none_or(|first| causes.all(|other| other == first))
    };
    let may_keep: Vec<bool> = (0..objects.len()).map(|id| !own.contains(&id) && same_causes(id)).collect();
    let may_always: Vec<bool> = (0..objects.len()).map(|id| !own.contains(&id)).collect();
    Memory {
        keep: slots(objects, &of_frame, &may_keep),
        smallest: slots(objects, &of_frame, &may_always),
        unshared: of_frame.iter().map(|id| bytes(&objects[*id].kind)).sum(),
        lower_bound: lower_bound(objects, &of_frame, own, passes.len()),
    }
}

/// Gives every object a slot, in order of first use: the free one of the nearest size, else a new one.
fn slots(objects: &[Object], of_frame: &[ObjectId], may: &[bool]) -> Vec<Slot> {
    let mut order = of_frame.to_vec();
    order.sort_by_key(|id| (objects[*id].lifetime, *id));
    let mut slots: Vec<(Slot, usize, bool)> = Vec::new();
    for id in order {
        let Some((first, last)) = objects[id].lifetime else { continue };
        let size = bytes(&objects[id].kind);
        let free = slots
            .iter_mut()
            .filter(|(slot, end, open)| {
                *open && may[id] && *end < first && fits(&objects[slot.objects[0]].kind, &objects[id].kind)
            })
            .min_by_key(|(slot, ..)| slot.bytes.abs_diff(size));
        match free {
            Some((slot, end, _)) => {
                slot.objects.push(id);
                slot.bytes = slot.bytes.max(size);
                *end = last;
            }
            None => slots.push((Slot { objects: vec![id], bytes: size }, last, may[id])),
        }
    }
    slots.into_iter().map(|(slot, ..)| slot).collect()
}

/// Textures share if they are described alike, buffers always: a slot is as large as its largest.
fn fits(a: &ObjectKind, b: &ObjectKind) -> bool {
    match (a, b) {
        (ObjectKind::Texture(x), ObjectKind::Texture(y)) => {
            (x.format, x.width, x.height, x.layers, x.is_3d, x.mips, x.samples)
                == (y.format, y.width, y.height, y.layers, y.is_3d, y.mips, y.samples)
        }
        (ObjectKind::Buffer(Buffer { .. }), ObjectKind::Buffer(Buffer { .. })) => true,
        _ => false,
    }
}

fn lower_bound(objects: &[Object], of_frame: &[ObjectId], own: &[ObjectId], passes: usize) -> u64 {
    // Bytes that begin and end at each pass; a running sum is the live set.
    let mut change = vec![0i64; passes + 1];
    for id in of_frame {
        let Some((first, last)) = objects[*id].lifetime else { continue };
        let size = bytes(&objects[*id].kind) as i64;
        let last = if own.contains(id) { passes.saturating_sub(1) } else { last };
        change[first] += size;
        change[last + 1] -= size;
    }
    let mut live = 0;
    change
        .iter()
        .map(|c| {
            live += c;
            live
        })
        .max()
        .unwrap_or(0)
        .max(0) as u64
}
