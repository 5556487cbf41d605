//! Passes as a person wants to see them: the iterations of an unrolled loop that differ only in
//! which of some like names they use are one row for each pass of the loop's body.

use std::collections::BTreeMap;
use std::ops::Range;

use super::describe;
use crate::plan::memory;
use crate::plan::merge::{self, Shared};
use crate::plan::model::{Access, ObjectId, ObjectKind, ObjectRef, Pass, Plan};

/// Loop bodies of more passes are shown pass by pass.
const LONGEST_BODY: usize = 64;

/// One row: a pass, or the same pass of all iterations of a loop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// Of the first iteration.
    pub first: usize,
    /// Passes from one iteration to the next; 0 for a single pass.
    pub stride: usize,
    /// Iterations.
    pub times: usize,
    /// The whole loop, the same for all rows of a body.
    pub all: Range<usize>,
}

impl Row {
    /// Every pass that the row stands for.
    pub fn passes(&self) -> impl Iterator<Item = usize> + use<> {
        let (first, stride) = (self.first, self.stride);
        (0..self.times).map(move |i| first + i * stride)
    }
}

/// All passes of a plan as rows, in program order.
pub fn rows(plan: &Plan) -> Vec<Row> {
    let shapes: Vec<String> = plan.passes.iter().map(shape).collect();
    let mut rows = Vec::new();
    let mut at = 0;
    while at < plan.passes.len() {
        let (body, times) = repeated(plan, &shapes, at);
        if times < 2 {
            rows.push(Row { first: at, stride: 0, times: 1, all: at..at + 1 });
            at += 1;
            continue;
        }
        let all = at..at + body * times;
        rows.extend((at..at + body).map(|first| Row { first, stride: body, times, all: all.clone() }));
        at = all.end;
    }
    rows
}

/// The shortest loop body that begins at a pass, and how often it comes in a row.
fn repeated(plan: &Plan, shapes: &[String], at: usize) -> (usize, usize) {
    let left = plan.passes.len() - at;
    for body in 1..=LONGEST_BODY.min(left / 2) {
        let alike = |from: usize| {
            (0..body)
                .all(|k| shapes[from + k] == shapes[at + k] && same(plan, &plan.passes[at + k], &plan.passes[from + k]))
        };
        // A loop, and not merely two passes that look alike.
        let counts = (0..body).any(|k| plan.passes[at + k].path.ends_with(']'));
        if shapes[at] != shapes[at + body] || !counts {
            continue;
        }
        let times = 1 + (1..left / body).take_while(|i| alike(at + i * body)).count();
        if times > 1 {
            return (body, times);
        }
    }
    (1, 1)
}

/// What two iterations of a pass have in common as text: path and work without the numbers of
/// iterations and of argument slots.
fn shape(pass: &Pass) -> String {
    let mut text = String::new();
    let mut skips = false;
    for c in pass.path.chars().chain("|".chars()).chain(describe::pass(pass).chars()) {
        match c {
            '[' | '#' => {
                skips = true;
                text.push(c);
            }
            c if skips && c.is_ascii_digit() => {}
            c => {
                skips = false;
                text.push(c);
            }
        }
    }
    text
}

/// Whether two passes do the same to like objects.
fn same(plan: &Plan, a: &Pass, b: &Pass) -> bool {
    let alike = |(x, y): (&Access, &Access)| {
        (&x.mips, &x.layers, x.read, x.write) == (&y.mips, &y.layers, y.read, y.write) && like(plan, x.object, y.object)
    };
    (a.unit, a.steps, a.unordered, a.accesses.len()) == (b.unit, b.steps, b.unordered, b.accesses.len())
        && a.accesses.iter().zip(&b.accesses).all(alike)
}

/// Whether two objects could swap.
fn like(plan: &Plan, a: ObjectRef, b: ObjectRef) -> bool {
    let (a, b) = (id(plan, a), id(plan, b));
    match (&plan.objects[a].kind, &plan.objects[b].kind) {
        _ if a == b => true,
        (ObjectKind::Texture(x), ObjectKind::Texture(y)) => {
            (x.format, x.width, x.height, x.layers, x.mips) == (y.format, y.width, y.height, y.layers, y.mips)
        }
        (ObjectKind::Buffer(x), ObjectKind::Buffer(y)) => (x.items, x.stride) == (y.items, y.stride),
        _ => false,
    }
}

/// The object behind a reference, for a ring as it is at the start.
pub fn id(plan: &Plan, object: ObjectRef) -> ObjectId {
    match object {
        ObjectRef::Fixed(id) => id,
        ObjectRef::Ring { ring, index } => plan.rings[ring].objects[index],
    }
}

/// A row's path: in a loop `smooth[0..4]`, with the first and last iteration.
pub fn path(plan: &Plan, row: &Row) -> String {
    let first = &plan.passes[row.first].path;
    let last = row.passes().last().map_or(first, |p| &plan.passes[p].path);
    let (mut text, mut ends) = (String::new(), last.split('[').skip(1));
    for (i, part) in first.split('[').enumerate() {
        let end = if i > 0 { ends.next() } else { None };
        match (part.split_once(']'), end.and_then(|e| e.split_once(']'))) {
            (Some((a, rest)), Some((b, _))) if a != b => text.push_str(&format!("[{a}..{b}]{rest}")),
            (Some((a, rest)), _) => text.push_str(&format!("[{a}]{rest}")),
            (None, _) => text.push_str(part),
        }
    }
    text
}

/// What a row reads, or writes: names that take turns are joined by `|`.
pub fn sides(plan: &Plan, row: &Row, read: bool) -> Vec<String> {
    let wanted = |access: &Access| if read { access.read } else { access.write };
    let mut columns: Vec<Vec<String>> = Vec::new();
    for p in row.passes() {
        for (i, access) in plan.passes[p].accesses.iter().filter(|a| wanted(a)).enumerate() {
            let name = describe::access(plan, access);
            if i == columns.len() {
                columns.push(Vec::new());
            }
            if !columns[i].contains(&name) {
                columns[i].push(name);
            }
        }
    }
    let mut names: Vec<String> = columns.into_iter().map(|names| names.join("|")).collect();
    let mut seen = std::collections::BTreeSet::new();
    names.retain(|name| seen.insert(name.clone()));
    names
}

/// What the row does, with how often.
pub fn what(plan: &Plan, row: &Row) -> String {
    let text = describe::pass(&plan.passes[row.first]);
    if row.times > 1 { format!("{text}, {} times", row.times) } else { text }
}

/// The passes of the device, under the plan's policy.
pub fn shared_passes(plan: &Plan) -> Vec<Shared> {
    let handles = shared_handles(plan);
    merge::shared(plan, &|id| handles[id])
}

/// For each object the first of those that it shares memory with under the plan's policy.
pub fn shared_handles(plan: &Plan) -> Vec<ObjectId> {
    let mut first: Vec<ObjectId> = (0..plan.objects.len()).collect();
    for slot in plan.memory.slots(plan.memory.policy) {
        slot.objects.iter().for_each(|id| first[*id] = slot.objects[0]);
    }
    first
}

/// For each object the label of the memory that it shares under the plan's policy.
pub fn shared(plan: &Plan) -> BTreeMap<ObjectId, String> {
    let mut labels = BTreeMap::new();
    for (n, slot) in plan.memory.slots(plan.memory.policy).iter().filter(|slot| slot.objects.len() > 1).enumerate() {
        labels.extend(slot.objects.iter().map(|id| (*id, format!("m{n}"))));
    }
    labels
}

/// Bytes that an object takes by itself.
pub fn size(plan: &Plan, id: ObjectId) -> String {
    describe::bytes(memory::bytes(&plan.objects[id].kind))
}
