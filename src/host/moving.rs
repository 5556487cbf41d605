//! Frames of things that move: nodes of animated meshes stand where their time says, in steps where the
//! step's does, and blended primitives are drawn from back to front.

use std::collections::BTreeMap;

use super::inputs::Input;
use super::meshes::Standing;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::engine::{Engine, Frame, Runner};
use crate::plan::meshes::MeshBuffer;
use crate::plan::model::{Object, ObjectRef, Origin, Plan};
use crate::scene::Camera;

/// Inputs by name, and where those of them that move stand.
pub(super) struct Moving<'a> {
    pub inputs: &'a BTreeMap<String, Input>,
    pub camera: &'a Camera,
    pub standing: &'a mut Standing,
}

impl Moving<'_> {
    /// Runs a frame. Steps that see meshes move run one at a time, each with these where they are
    /// then, after those that come before them in the program; all others run as the engine does them, by `run`.
    pub fn run<T>(
        &mut self,
        engine: &Engine,
        runner: &mut Runner,
        frame: &Frame<'_>,
        run: impl FnOnce(&mut Runner, &Engine, &Frame<'_>) -> Result<T, Diagnostics>,
    ) -> Result<T, Diagnostics> {
        let turns = self.turns(runner.plan());
        // Most see none, and their frames allocate nothing.
        let mut left = if turns.is_empty() { Vec::new() } else { frame.steps.to_vec() };
        for (index, sees) in &turns {
            let due = left.get_mut(*index).map_or(0, std::mem::take);
            let (times, count) = if *sees { (due, 1) } else { (due.min(1), due) };
            for _ in 0..times {
                self.step(engine, runner, frame, (*index, count))?;
            }
        }
        self.move_to(engine, runner, frame.time)?;
        self.sort(runner, frame.time);
        run(runner, engine, &Frame { steps: if turns.is_empty() { frame.steps } else { &left }, ..*frame })
    }

    /// So many steps of `plan.steps[index]`, with what comes before them in the program; meshes are where they are in
    /// the last one.
    fn step(
        &mut self,
        engine: &Engine,
        runner: &mut Runner,
        frame: &Frame<'_>,
        (index, count): (usize, u32),
    ) -> Result<(), Diagnostics> {
        let steps = &runner.plan().steps[index];
        let done = runner.steps_done()[index] + u64::from(count);
        let time_s = steps.rate.map_or(frame.time, |rate| done as f64 / rate);
        let end = steps.passes.end;
        let is_asked = |pass: usize| frame.only.is_none_or(|only| only.get(pass) != Some(&false));
        let only: Vec<bool> = (0..runner.plan().passes.len()).map(|pass| pass < end && is_asked(pass)).collect();
        let mut some = vec![0; runner.plan().steps.len()];
        some[index] = count;
        self.move_to(engine, runner, time_s)?;
        runner.advance(engine, &Frame { steps: &some, only: Some(&only), ..*frame })
    }

    /// The `Steps` at a rate in which a pass reads where animated meshes are, and those before them, in program order;
    /// with each whether it does.
    fn turns(&self, plan: &Plan) -> Vec<(usize, bool)> {
        let moves = |object: &ObjectRef| match object {
            ObjectRef::Fixed(id) => self.is_moving(&plan.objects[*id]),
            ObjectRef::Ring { .. } => false,
        };
        let sees = |index: &usize| {
            let steps = &plan.steps[*index];
            let passes = plan.passes.get(steps.passes.clone()).unwrap_or_default();
            steps.rate.is_some() && passes.iter().flat_map(|pass| &pass.accesses).any(|access| moves(&access.object))
        };
        if !(0..plan.steps.len()).any(|index| sees(&index)) {
            return Vec::new();
        }
        let mut turns: Vec<(usize, bool)> = (0..plan.steps.len()).map(|index| (index, sees(&index))).collect();
        turns.sort_by_key(|(index, _)| plan.steps[*index].passes.start);
        turns.truncate(turns.iter().rposition(|(_, sees)| *sees).map_or(0, |last| last + 1));
        turns
    }

    fn is_moving(&self, object: &Object) -> bool {
        let Origin::Mesh { input, buffer: MeshBuffer::Instances } = &object.origin else { return false };
        matches!(self.inputs.get(input), Some(Input::Meshes(meshes)) if meshes.info.animated)
    }

    /// Puts what time moves where it is at a time in seconds.
    fn move_to(&mut self, engine: &Engine, runner: &mut Runner, time_s: f64) -> Result<(), Diagnostic> {
        // While time stands, nothing is new.
        if self.standing.at_s.replace(time_s) == Some(time_s) {
            return Ok(());
        }
        for id in 0..runner.plan().objects.len() {
            let object = &runner.plan().objects[id];
            if self.is_moving(object)
                && let Some(Input::Meshes(meshes)) = object.origin.input().and_then(|name| self.inputs.get(name))
            {
                meshes.instances_into(time_s, self.standing);
                runner.upload_buffer(engine, id, &self.standing.bytes)?;
            }
        }
        Ok(())
    }

    /// What blends goes from back to front, as the camera sees it.
    fn sort(&mut self, runner: &mut Runner, time_s: f64) {
        for (name, input) in self.inputs {
            if let Input::Meshes(meshes) = input
                && meshes.blends_several()
            {
                meshes.away_into(self.camera.eye.as_vec3(), time_s, self.standing);
                let away_m = &self.standing.away_m;
                runner.sort_blended(name, &|instance| away_m.get(&instance).copied().unwrap_or(0.0));
            }
        }
    }
}
