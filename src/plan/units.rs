//! Units: passes that run or are skipped together, and what makes them run (rule 37).

use std::collections::BTreeMap;

use super::lower::Lowering;
use super::model::{Causes, ObjectId, Unit};

/// Groups the passes into units, numbers them in program order, and closes their causes.
pub(super) fn units(lowering: &mut Lowering<'_>) -> Vec<Unit> {
    let group = groups(lowering);
    let mut sets = Sets::new(lowering.flat.len());
    // Passes that write one group, and readers of a version other than the last.
    let mut writers: BTreeMap<ObjectId, Vec<usize>> = BTreeMap::new();
    let mut steps: BTreeMap<usize, usize> = BTreeMap::new();
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
        let flat = &mut lowering.flat[p];
        flat.pass.unit = unit;
        units[unit].passes.push(p);
        units[unit].causes.add(&flat.causes);
    }
    let sources: Vec<Vec<usize>> = units
        .iter()
        .enumerate()
        .map(|(u, unit)| {
            let mut from: Vec<usize> =
                unit.passes.iter().flat_map(|p| &producers[*p]).map(|p| lowering.flat[*p].pass.unit).collect();
            from.sort_unstable();
            from.dedup();
            from.retain(|other| *other != u);
            from
        })
        .collect();
    close(&mut units, &sources);
    units
}

/// Adds to every unit the causes of those that it reads from, until nothing changes.
fn close(units: &mut [Unit], sources: &[Vec<usize>]) {
    loop {
        let mut changed = false;
        for u in 0..units.len() {
            for from in &sources[u] {
                let more: Causes = units[*from].causes.clone();
                let before = size(&units[u].causes);
                units[u].causes.add(&more);
                changed |= size(&units[u].causes) != before;
            }
        }
        if !changed {
            return;
        }
    }
}

fn size(causes: &Causes) -> usize {
    causes.inputs.len() + causes.live.len() + causes.params.len() + usize::from(causes.viewport)
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
