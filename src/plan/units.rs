//! Units: passes that run or are skipped together, and what makes them run (rule 37).

use std::collections::{BTreeMap, HashMap, VecDeque};

use super::lower::{CauseKind, CauseSet, Lowering};
use super::model::{ObjectId, PassKind, Unit};

/// Groups the passes into units, numbers them in program order, and closes their causes. Also gives,
/// for each unit of steps, all that it is made from, through other steps too.
pub(super) fn units(lowering: &mut Lowering<'_>) -> (Vec<Unit>, BTreeMap<usize, CauseSet>) {
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
            kind => {
                if let Some(copy) = kind.slot().and_then(|slot| copied.get(&slot)) {
                    sets.join(*copy, p);
                }
            }
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
    let mut all: Vec<CauseSet> = units.iter().map(|unit| own_causes(lowering, unit)).collect();
    let only_steps: Vec<bool> =
        units.iter().map(|unit| unit.passes.iter().all(|p| lowering.flat[*p].pass.steps.is_some())).collect();
    let own = all.clone();
    let mut through = all.clone();
    // That a step ran.
    let step = lowering.causes.set(CauseKind::Live, "step");
    close(&mut all, &readers, &only_steps, &step);
    let mut made_from = BTreeMap::new();
    if !steps.is_empty() {
        close(&mut through, &readers, &vec![false; units.len()], &step);
        let of_steps = steps.values().map(|p| lowering.flat[*p].pass.unit);
        made_from.extend(of_steps.map(|unit| (unit, through[unit].clone())));
    }
    for (((unit, all), own), readers) in units.iter_mut().zip(&all).zip(&own).zip(readers) {
        unit.own = lowering.causes.named(own);
        unit.causes = lowering.causes.named(all);
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
fn close(all: &mut [CauseSet], readers: &[Vec<usize>], only_steps: &[bool], step: &CauseSet) {
    let mut queue: VecDeque<usize> = (0..all.len()).collect();
    let mut queued = vec![true; all.len()];
    while let Some(from) = queue.pop_front() {
        queued[from] = false;
        let given = if only_steps[from] { step.clone() } else { all[from].clone() };
        for to in &readers[from] {
            if all[*to].add(&given) && !std::mem::replace(&mut queued[*to], true) {
                queue.push_back(*to);
            }
        }
    }
}

/// What the passes of a unit depend on by themselves.
fn own_causes(lowering: &Lowering<'_>, unit: &Unit) -> CauseSet {
    let mut causes = CauseSet::default();
    unit.passes.iter().for_each(|p| _ = causes.add(&lowering.flat[*p].causes));
    causes
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
