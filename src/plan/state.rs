//! The rules of state: written inside exactly one `Steps`, and what makes all of it start anew.

use std::collections::{BTreeMap, BTreeSet};

use super::lower::{CauseKind, CauseSet, Lowering, fault, traced};
use super::model::{ObjectId, Origin};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::graph::model::InputKind;

/// What passes do with one object of state.
#[derive(Default)]
struct Touched {
    /// The first place in each `Steps` that writes it.
    writers: BTreeMap<usize, Span>,
    /// Passes outside that write it, and where.
    outside: Vec<(usize, Span)>,
    is_read: bool,
}

/// State is written inside exactly one `Steps`, which it then belongs to.
pub(super) fn check(lowering: &mut Lowering<'_>) -> Vec<Diagnostic> {
    let mut faults = Vec::new();
    for (id, touched) in touched(lowering) {
        let object = &lowering.objects[id].object;
        for (pass, place) in &touched.outside {
            let message = format!("the state `{}` is written outside `Steps`", object.path);
            let diagnostic = fault(Code::STATE, message, *place, "written here")
                .see(object.span, "declared as state")
                .hint("state is what happens over time: write it inside `Steps`, or declare it under `resources:`");
            faults.push(*traced(diagnostic, &lowering.flat[*pass].trace));
        }
        if touched.writers.len() > 1 {
            let message =
                format!("the state `{}` is written in {} different `Steps`", object.path, touched.writers.len());
            let mut diagnostic = Diagnostic::error(Code::STATE, message);
            for (steps, at) in &touched.writers {
                diagnostic = diagnostic.at(*at, format!("written in `{}`", lowering.steps[*steps].path));
            }
            let diagnostic = diagnostic.see(object.span, "declared as state");
            faults.push(diagnostic.hint("state belongs to one `Steps`: give the other one its own"));
        }
        match touched.writers.keys().next() {
            Some(steps) => lowering.objects[id].object.origin = Origin::State(*steps),
            None if touched.is_read && faults.is_empty() => {
                let message = format!("nothing writes the state `{}`", object.path);
                let diagnostic = fault(Code::NEVER_WRITTEN, message, object.span, "declared as state")
                    .hint("write it inside `Steps(rate: ..., passes: [...])`");
                faults.push(diagnostic);
            }
            None => {}
        }
    }
    faults
}

/// Every object of state, with what passes do with it: one walk over the passes.
fn touched(lowering: &Lowering<'_>) -> BTreeMap<ObjectId, Touched> {
    let is_state = |id: &ObjectId| matches!(lowering.objects[*id].object.origin, Origin::State(_));
    let mut all: BTreeMap<ObjectId, Touched> =
        (0..lowering.objects.len()).filter(is_state).map(|id| (id, Touched::default())).collect();
    if all.is_empty() {
        return all;
    }
    for (pass, flat) in lowering.flat.iter().enumerate() {
        for (access, place) in flat.pass.accesses.iter().zip(&flat.places) {
            for id in lowering.object_ids(access.object) {
                let Some(touched) = all.get_mut(&id) else { continue };
                touched.is_read |= access.read;
                match flat.pass.steps {
                    Some(steps) if access.write => _ = touched.writers.entry(steps).or_insert(place.graph),
                    None if access.write => touched.outside.push((pass, place.graph)),
                    _ => {}
                }
            }
        }
    }
    all
}

/// Which state belongs to which steps, when it starts anew, and the rule that steps at a rate do
/// not see the camera. `made_from` has what each unit of steps is made from.
pub(super) fn seal(lowering: &mut Lowering<'_>, made_from: &BTreeMap<usize, CauseSet>) {
    let inputs = &lowering.program.root.inputs;
    let cameras: BTreeSet<&str> =
        inputs.iter().filter(|i| matches!(i.kind, InputKind::Camera)).map(|i| i.name.value.as_str()).collect();
    let of_camera = |name: &str| name.split_once('.').is_some_and(|(input, _)| cameras.contains(input));
    let cameras = lowering.causes.such(CauseKind::Live, of_camera);
    for index in 0..lowering.steps.len() {
        let state: Vec<ObjectId> = (0..lowering.objects.len())
            .filter(|id| lowering.objects[*id].object.origin == Origin::State(index))
            .collect();
        let steps = &lowering.steps[index];
        let mut text = format!("{}|{:?}", steps.path, steps.asked);
        for id in &state {
            let object = &lowering.objects[*id].object;
            text.push_str(&format!("|{}:{:?}", object.path, object.kind));
        }
        lowering.steps[index].key = twox_hash::XxHash3_128::oneshot(text.as_bytes());
        lowering.steps[index].state = state;
        if lowering.steps[index].rate.is_some()
            && let Some(fault) = sees_camera(lowering, made_from, index, &cameras)
        {
            lowering.diagnostics.push(*fault);
        }
    }
}

/// A pass of the steps that depends on the camera.
fn sees_camera(
    lowering: &Lowering<'_>,
    made_from: &BTreeMap<usize, CauseSet>,
    steps: usize,
    cameras: &CauseSet,
) -> Option<Box<Diagnostic>> {
    let of_camera = |unit: usize| made_from.get(&unit).is_some_and(|causes| causes.meets(cameras));
    let flat = lowering.flat.iter().find(|f| f.pass.steps == Some(steps) && of_camera(f.pass.unit))?;
    let message = format!("`{}` runs at a rate and depends on the camera", flat.pass.path);
    let mut diagnostic = Diagnostic::error(Code::STATE, message).at(flat.word, "this pass");
    if let Some(by) = lowering.flat.iter().find(|other| other.causes.meets(cameras)).filter(|by| by.word != flat.word) {
        diagnostic = diagnostic.see(by.word, "reads the camera, and what it makes comes there");
    }
    let diagnostic =
        diagnostic.hint("what happens over time is the same from every viewpoint; say `rate: PerFrame` if it is not");
    Some(traced(diagnostic, &flat.trace))
}
