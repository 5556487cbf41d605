//! From plan to plan: what ran under the plan before needs not run again.

use std::collections::HashMap;

use super::answers::{self, Answers};
use super::reason::Reason;
use super::{Cause, Changes, Marks, objects};
use crate::plan::model::{ObjectId, Plan, Policy};

impl Changes {
    /// Takes over from a plan before what needs not run again: units of the same passes, by their
    /// instance paths, whose parameters are the same. `kept` says of which objects the content goes
    /// over, `shares` as in [`Changes::new`].
    pub fn carry(
        &mut self,
        plan: &Plan,
        (before, old): (&Plan, &Changes),
        kept: &dyn Fn(ObjectId) -> bool,
        shares: &dyn Fn(ObjectId) -> bool,
    ) {
        let of_first: HashMap<&str, usize> = (before.units.iter().enumerate())
            .filter_map(|(u, unit)| Some((before.passes[*unit.passes.first()?].path.as_str(), u)))
            .collect();
        let mut carried: Vec<(usize, usize)> = Vec::new();
        for (u, unit) in plan.units.iter().enumerate() {
            let Some(first) = unit.passes.first() else { continue };
            let Some(&was) = of_first.get(plan.passes[*first].path.as_str()) else { continue };
            let then = &before.units[was].passes;
            let same_paths = then.len() == unit.passes.len()
                && then.iter().zip(&unit.passes).all(|(a, b)| before.passes[*a].path == plan.passes[*b].path);
            if !same_paths {
                continue;
            }
            self.pending.marks[u] = old.pending.marks[was];
            if then.iter().zip(&unit.passes).any(|(a, b)| old.prints[*a] != self.prints[*b]) {
                self.pending.marks[u].add(&Reason::Pass);
            }
            // Where things are not kept what is looked at may share too, and all run if one does.
            let counts = |id: ObjectId| !shares(id) || plan.memory.policy != Policy::Keep;
            let lost = unit
                .passes
                .iter()
                .flat_map(|p| &plan.passes[*p].accesses)
                .any(|access| objects(plan, &access.object).into_iter().any(|id| counts(id) && !kept(id)));
            if lost {
                self.pending.marks[u].add(&Reason::Memory);
            }
            self.carry_causes(u, old, was);
            carried.push((u, was));
        }
        self.carry_values(plan, before, old);
        self.find_unanswered(plan, before, &carried, &|id| kept(id) && !shares(id));
    }

    /// Looks among the units that are not to run for those that settle counts for others than before. `there` says of
    /// which objects the content is there as the unit left it.
    fn find_unanswered(
        &mut self,
        plan: &Plan,
        before: &Plan,
        carried: &[(usize, usize)],
        there: &dyn Fn(ObjectId) -> bool,
    ) {
        let (asked, answered) = (Answers::new(plan), Answers::new(before));
        for &(u, was) in carried {
            if self.waits(u) {
                continue;
            }
            for (a, b) in before.units[was].passes.iter().zip(&plan.units[u].passes) {
                if asked.are_among(*b, &answered, *a) {
                    continue;
                }
                if answers::can_be_given_again(plan, *b, there) {
                    self.unanswered.push(*b);
                } else {
                    self.pending.marks[u].add(&Reason::Pass);
                }
            }
        }
    }

    /// What the unit had yet to run for.
    fn carry_causes(&mut self, unit: usize, old: &Changes, was: usize) {
        for (n, cause) in old.causes.iter().enumerate() {
            if super::bit(&old.pending.changed, old.words, was, n)
                && let Some(n) = self.causes.iter().position(|c| c == cause)
                && super::bit(&self.of, self.words, unit, n)
            {
                self.pending.changed[unit * self.words + n / 64] |= 1 << (n % 64);
            }
        }
    }

    /// The values of causes, and which of them the new plan has others of.
    fn carry_values(&mut self, plan: &Plan, before: &Plan, old: &Changes) {
        for at in 0..self.live.len() {
            let cause = &self.causes[self.live[at].0];
            let last = old.live.iter().find(|(n, _)| old.causes[*n] == *cause);
            self.live[at].1 = last.and_then(|(_, value)| value.clone());
        }
        let changed = |cause: &Cause| match cause {
            Cause::Param(path) => {
                let value = |plan: &Plan| plan.params.iter().find(|p| p.path == *path).map(|p| p.value.clone());
                value(plan) != value(before)
            }
            Cause::Viewport => plan.viewport != before.viewport,
            Cause::Input(_) | Cause::Live(_) => false,
        };
        for n in 0..self.causes.len() {
            if changed(&self.causes[n]) {
                self.note(n);
            }
        }
        for (steps, stepped) in plan.steps.iter().zip(&mut self.stepped) {
            let was = before.steps.iter().position(|s| s.path == steps.path);
            *stepped = was.is_none_or(|was| old.stepped[was]);
        }
    }
}

impl Changes {
    /// Passes that settle counts for others than under the plan before: what they wrote is good, but those others
    /// have no arguments yet. They lie outside of `Steps`, and what they settled is still there.
    pub fn unanswered(&self) -> &[usize] {
        &self.unanswered
    }

    /// How many units have something to run for.
    pub fn waiting(&self) -> usize {
        (0..self.nodes.len()).filter(|u| self.waits(*u)).count()
    }

    fn waits(&self, unit: usize) -> bool {
        self.pending.marks[unit] != Marks::default()
            || self.pending.changed[unit * self.words..(unit + 1) * self.words].iter().any(|word| *word != 0)
    }
}
