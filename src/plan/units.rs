//! Units: passes that run or are skipped together, and what makes them run (rule 37).

use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};

use super::lower::Lowering;
use super::model::{Causes, Geometry, ObjectId, PassKind, Unit};

/// Groups the passes into units, numbers them in program order, and closes their causes. Also gives,
/// for each unit of steps, all that it is made from, through other steps too.
pub(super) fn units(lowering: &mut Lowering<'_>) -> (Vec<Unit>, BTreeMap<usize, Causes>) {
    let group = groups(lowering);
    let mut sets = Sets::new(lowering.flat.len());
    // Passes that write one group, and readers of a version other than the last.
    let mut writers: BTreeMap<ObjectId, Vec<usize>> = BTreeMap::new();
    let mut steps: BTreeMap<usize, usize> = BTreeMap::new();
    let mut copied: HashMap<u32, usize> = HashMap::new();
    for (p, flat) in lowering.flat.iter().enumerate() {
        for access in flat.pass.accesses.iter().filter(|a| a.write) {
            let written = writers.entry(group[lowering.object_id(access.object)]).or_default();
            if let Some(first) = written.first() {
                sets.join(*first, p);
            }
            if written.last() != Some(&p) {
                written.push(p);
            }
        }
        if let Some(index) = flat.pass.steps {
            sets.join(*steps.entry(index).or_insert(p), p);
        }
        // Arguments are copied for one draw, to a place that no name stands for.
        match &flat.pass.kind {
            PassKind::Arguments { slot, .. } => _ = copied.insert(*slot, p),
            PassKind::Draw(draw) => {
                if let Geometry::Indirect { slot, .. } = &draw.geometry
                    && let Some(copy) = copied.get(slot)
                {
                    sets.join(*copy, p);
                }
            }
            _ => {}
        }
    }
    let mut producers: Vec<Vec<usize>> = vec![Vec::new(); lowering.flat.len()];
    for (p, flat) in lowering.flat.iter().enumerate() {
        for access in flat.pass.accesses.iter().filter(|a| a.read) {
            let Some(written) = writers.get(&group[lowering.object_id(access.object)]) else { continue };
            if written.last().is_some_and(|last| *last > p) {
                sets.join(written[0], p);
            }
            producers[p].push(written[0]);
        }
    }
    let mut number = BTreeMap::new();
    let mut units: Vec<Unit> = Vec::new();
    for p in 0..lowering.flat.len() {
        let unit = *number.entry(sets.find(p)).or_insert_with(|| {
            units.push(Unit::default());
            units.len() - 1
        });
        lowering.flat[p].pass.unit = unit;
        units[unit].passes.push(p);
    }
    let readers = readers(lowering, &units, &producers);
    let names = Names::new(lowering);
    let mut bits: Vec<Bits> = units
        .iter()
        .map(|unit| {
            let mut bits = names.none();
            unit.passes.iter().for_each(|p| names.set(&mut bits, &lowering.flat[*p].causes));
            bits
        })
        .collect();
    let only_steps: Vec<bool> =
        units.iter().map(|unit| unit.passes.iter().all(|p| lowering.flat[*p].pass.steps.is_some())).collect();
    let own = bits.clone();
    let mut through = bits.clone();
    close(&mut bits, &readers, &only_steps, &names.step());
    let mut made_from = BTreeMap::new();
    if !steps.is_empty() {
        close(&mut through, &readers, &vec![false; units.len()], &names.step());
        let of_steps = steps.values().map(|p| lowering.flat[*p].pass.unit);
        made_from.extend(of_steps.map(|unit| (unit, names.causes(&through[unit]))));
    }
    for (((unit, bits), own), readers) in units.iter_mut().zip(&bits).zip(&own).zip(readers) {
        unit.own = names.causes(own);
        unit.causes = names.causes(bits);
        unit.readers = readers;
    }
    (units, made_from)
}

/// For each unit those that read from it, without itself.
fn readers(lowering: &Lowering<'_>, units: &[Unit], producers: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut readers: Vec<Vec<usize>> = vec![Vec::new(); units.len()];
    for (u, unit) in units.iter().enumerate() {
        for from in unit.passes.iter().flat_map(|p| &producers[*p]).map(|p| lowering.flat[*p].pass.unit) {
            if from != u && readers[from].last() != Some(&u) {
                readers[from].push(u);
            }
        }
    }
    readers
}

/// Hands every unit's causes on to its readers, until nothing changes. What comes out of steps is
/// another only when a step ran, whatever the step was made from.
fn close(bits: &mut [Bits], readers: &[Vec<usize>], only_steps: &[bool], step: &Bits) {
    let mut queue: VecDeque<usize> = (0..bits.len()).collect();
    let mut queued = vec![true; bits.len()];
    while let Some(from) = queue.pop_front() {
        queued[from] = false;
        let given = if only_steps[from] { step.clone() } else { bits[from].clone() };
        for to in &readers[from] {
            let mut changed = false;
            for (have, more) in bits[*to].iter_mut().zip(&given) {
                changed |= *more & !*have != 0;
                *have |= more;
            }
            if changed && !std::mem::replace(&mut queued[*to], true) {
                queue.push_back(*to);
            }
        }
    }
}

/// A set of causes, as bits by [`Names`].
type Bits = Vec<u64>;

/// A kind of cause.
#[derive(Clone, Copy)]
enum Kind {
    Input,
    Live,
    Param,
    Viewport,
}

/// Every cause that a pass has by itself, by number: closing over sets of strings would take
/// most of the time of planning.
struct Names {
    all: Vec<(Kind, String)>,
    number: [HashMap<String, usize>; 4],
}

impl Names {
    fn new(lowering: &Lowering<'_>) -> Self {
        let mut names = Self { all: Vec::new(), number: Default::default() };
        for flat in &lowering.flat {
            for (kind, name) in each(&flat.causes) {
                if !names.number[kind as usize].contains_key(name) {
                    names.number[kind as usize].insert(name.to_owned(), names.all.len());
                    names.all.push((kind, name.to_owned()));
                }
            }
        }
        names
    }

    fn none(&self) -> Bits {
        vec![0; self.all.len().div_ceil(64)]
    }

    fn set(&self, bits: &mut Bits, causes: &Causes) {
        for (kind, name) in each(causes) {
            if let Some(n) = self.number[kind as usize].get(name) {
                bits[n / 64] |= 1 << (n % 64);
            }
        }
    }

    /// That a step ran.
    fn step(&self) -> Bits {
        let mut bits = self.none();
        self.set(&mut bits, &Causes { live: ["step".to_owned()].into(), ..Causes::default() });
        bits
    }

    fn causes(&self, bits: &Bits) -> Causes {
        let mut causes = Causes::default();
        for (n, (kind, name)) in self.all.iter().enumerate() {
            if bits[n / 64] & (1 << (n % 64)) == 0 {
                continue;
            }
            match kind {
                Kind::Input => _ = causes.inputs.insert(name.clone()),
                Kind::Live => _ = causes.live.insert(name.clone()),
                Kind::Param => _ = causes.params.insert(name.clone()),
                Kind::Viewport => causes.viewport = true,
            }
        }
        causes
    }
}

fn each(causes: &Causes) -> impl Iterator<Item = (Kind, &str)> {
    fn of(kind: Kind, names: &BTreeSet<String>) -> impl Iterator<Item = (Kind, &str)> {
        names.iter().map(move |name| (kind, name.as_str()))
    }
    of(Kind::Input, &causes.inputs)
        .chain(of(Kind::Live, &causes.live))
        .chain(of(Kind::Param, &causes.params))
        .chain(causes.viewport.then_some((Kind::Viewport, "")))
}

/// For each object a number that objects whose names swap share.
fn groups(lowering: &Lowering<'_>) -> Vec<usize> {
    let mut sets = Sets::new(lowering.objects.len());
    for swapped in &lowering.swapped {
        let mut all = swapped.iter();
        if let Some(first) = all.next() {
            all.for_each(|other| sets.join(*first, *other));
        }
    }
    (0..lowering.objects.len()).map(|id| sets.find(id)).collect()
}

/// Disjoint sets; the smallest member represents its set.
struct Sets(Vec<usize>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn find(&mut self, mut x: usize) -> usize {
        while self.0[x] != x {
            self.0[x] = self.0[self.0[x]];
            x = self.0[x];
        }
        x
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b);
    }
}
