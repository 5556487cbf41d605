//! `Steps`: what happens over time, as a contiguous range of passes.

use super::names::join;
use super::{CauseKind, CauseSet, Lowering, Result, ScopeId, VarId, fault, traced};
use crate::diagnostic::{Code, Span};
use crate::graph::model as ast;
use crate::plan::model::{ObjectRef, Steps};

impl Lowering<'_> {
    pub(super) fn steps(&mut self, s: ScopeId, steps: &ast::Steps, word: Span) -> Result<()> {
        if self.in_steps.is_some() {
            let diagnostic = fault(Code::STATE, "`Steps` inside `Steps`", word, "the inner one");
            return Err(traced(diagnostic, &self.scopes[s].trace));
        }
        let mut causes = CauseSet::default();
        let rate = match &steps.rate {
            Some(expr) => {
                let (rate, depends) = self.number(s, expr)?;
                causes.add(&depends);
                if rate <= 0.0 {
                    let message = format!("the rate must be above 0 Hz, and is {rate}");
                    return Err(traced(
                        fault(Code::OUT_OF_RANGE, message, expr.span, "the rate"),
                        &self.scopes[s].trace,
                    ));
                }
                Some(rate)
            }
            None => None,
        };
        let asked = match &steps.key {
            Some(expr) => {
                let (value, depends) = self.known(s, expr)?;
                causes.add(&depends);
                Some(value)
            }
            None => None,
        };
        let name = steps.name.as_ref().map_or("steps", |n| n.value.as_str());
        let index = self.steps.len();
        let path = join(&self.scopes[s].path, name);
        let first = self.flat.len();
        self.steps.push(Steps { path, rate, passes: first..first, asked, key: 0, state: Vec::new() });
        let before: Vec<ObjectRef> = self.vars.iter().map(|v| v.now).collect();
        self.in_steps = Some(index);
        causes.add(&self.causes.set(CauseKind::Live, "step"));
        self.structure.push(causes);
        self.nodes(s, &steps.passes);
        self.structure.pop();
        self.in_steps = None;
        self.steps[index].passes = first..self.flat.len();
        self.close_steps(s, index, &before, word)
    }

    /// How far each ring turned in a step, and whether anything else ended up swapped.
    fn close_steps(&mut self, s: ScopeId, index: usize, before: &[ObjectRef], word: Span) -> Result<()> {
        // A variable that was first asked for inside had the object that was made with it.
        let at_start = |v: VarId| before.get(v).copied().unwrap_or(ObjectRef::Fixed(v));
        for v in 0..self.vars.len() {
            let now = self.vars[v].now;
            match now {
                ObjectRef::Ring { ring, index: at } if self.rings[ring].steps == index => {
                    let objects = &self.rings[ring].objects;
                    let n = objects.len();
                    let home = match at_start(v) {
                        ObjectRef::Fixed(id) => objects.iter().position(|o| *o == id).unwrap_or(at),
                        ObjectRef::Ring { index, .. } => index,
                    };
                    // Name `home` now has what `at` had; the next step must start from there.
                    self.rings[ring].turn = (at + n - home) % n;
                    self.vars[v].now = ObjectRef::Ring { ring, index: home };
                }
                // What only the steps name holds nothing from one step to the next, whatever it swaps with.
                ObjectRef::Fixed(id) if v < before.len() && at_start(v) != now => {
                    let name = self.objects[id].object.path.clone();
                    let message = format!("`{name}` swaps inside `Steps` and is no state");
                    let diagnostic = fault(Code::STATE, message, word, "an odd number of swaps in a step")
                        .see(self.objects[id].object.span, "declared here")
                        .hint("declare it under `state:`");
                    return Err(traced(diagnostic, &self.scopes[s].trace));
                }
                _ => {}
            }
        }
        Ok(())
    }
}
