//! What a build did to state, for people: all state of one `Steps` goes on together, or starts anew
//! and that is told.

use std::collections::BTreeMap;

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::graph::value::Value;
use crate::plan::model::{ObjectKind, Plan};

/// What the state of a plan's `Steps` was, by their paths.
#[derive(Debug, Default)]
pub(super) struct Held(BTreeMap<String, Steps>);

#[derive(Debug)]
struct Steps {
    asked: Option<Value>,
    state: BTreeMap<String, ObjectKind>,
}

impl Held {
    pub fn of(plan: &Plan) -> Self {
        let steps = plan.steps.iter().map(|steps| {
            let objects = steps.state.iter().map(|id| &plan.objects[*id]);
            let state = objects.map(|object| (object.path.clone(), object.kind.clone())).collect();
            (steps.path.clone(), Steps { asked: steps.asked.clone(), state })
        });
        Self(steps.collect())
    }

    /// Which state starts anew now, and why. `kept` tells for each `Steps` whether its state went over.
    pub fn resets(&self, now: &Plan, kept: &BTreeMap<String, bool>) -> Diagnostics {
        let mut found = Diagnostics::new();
        let after = Self::of(now);
        for (path, before) in &self.0 {
            let why = match after.0.get(path) {
                None => format!("the state of `{path}` is gone, and starts anew if its passes come back"),
                Some(_) if kept.get(path) == Some(&true) => continue,
                Some(after) => format!("the state of `{path}` starts anew: {}", reason(before, after)),
            };
            if !before.state.is_empty() {
                found.push(Diagnostic::note(Code::STATE, why));
            }
        }
        found
    }
}

fn reason(before: &Steps, after: &Steps) -> String {
    if let (Some(old), Some(new)) = (&before.asked, &after.asked)
        && old != new
    {
        return format!("its key was {old} and is {new}");
    }
    let changed = after.state.iter().find(|(path, kind)| before.state.get(*path).is_some_and(|old| old != *kind));
    let added = after.state.keys().find(|path| !before.state.contains_key(*path));
    let gone = before.state.keys().find(|path| !after.state.contains_key(*path));
    match (changed, added, gone) {
        (Some((path, _)), ..) => format!("`{path}` is another than it was"),
        (_, Some(path), _) => format!("`{path}` is new"),
        (_, _, Some(path)) => format!("`{path}` is gone"),
        _ => "what it swaps or how it is keyed changed".into(),
    }
}
