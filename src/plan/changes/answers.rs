//! For whom counts are settled. A branch that is taken may bring draws of a count that was settled long
//! before: their arguments follow from the count, and nobody else has to run for them.

use std::collections::HashMap;

use super::objects;
use crate::plan::model::{Argument, ArgumentKind, ObjectId, PassKind, Plan};

/// Whom the settling passes of a plan write arguments for.
pub(super) struct Answers<'p> {
    plan: &'p Plan,
    /// The paths of those that have their arguments from a slot.
    consumers: HashMap<u32, &'p str>,
}

impl<'p> Answers<'p> {
    pub fn new(plan: &'p Plan) -> Self {
        let of = |pass: &'p crate::plan::model::Pass| Some((pass.kind.slot()?, pass.path.as_str()));
        Self { plan, consumers: plan.passes.iter().filter_map(of).collect() }
    }

    /// Whether all that a pass settles for had the same arguments from a pass of the plan before.
    pub fn are_among(&self, pass: usize, before: &Answers<'_>, was: usize) -> bool {
        let given: Vec<_> = before.of(was).collect();
        self.of(pass).all(|answer| given.contains(&answer))
    }

    fn of(&self, pass: usize) -> impl Iterator<Item = (Option<&'p str>, &'p ArgumentKind)> {
        let arguments: &'p [Argument] = match &self.plan.passes[pass].kind {
            PassKind::Settle { arguments, .. } => arguments,
            _ => &[],
        };
        arguments.iter().map(|argument| (self.consumers.get(&argument.slot).copied(), &argument.kind))
    }
}

/// Whether the count that a pass settled is as it left it, where the content of its objects is `there` after a frame.
pub(super) fn can_be_given_again(plan: &Plan, pass: usize, there: &dyn Fn(ObjectId) -> bool) -> bool {
    let PassKind::Settle { counted, .. } = &plan.passes[pass].kind else { return false };
    let counted = objects(plan, counted);
    let mut later = plan.passes[pass + 1..].iter().flat_map(|pass| &pass.accesses).filter(|access| access.write);
    plan.passes[pass].steps.is_none()
        && counted.iter().all(|id| there(*id))
        && !later.any(|access| objects(plan, &access.object).iter().any(|id| counted.contains(id)))
}
