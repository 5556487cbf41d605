//! What a person asked for.

use std::time::Instant;

use super::{Core, Hunt};
use crate::diagnostic::Diagnostics;
use crate::graph::value::Value;
use crate::scene::Pointing;
use crate::viewer::action::Action;
use crate::viewer::{camera, editor, viewpoints};

impl Core {
    pub fn act(&mut self, action: Action) {
        match action {
            Action::Open(path) => self.open_path(path),
            Action::TakeAway(path) => self.take_away(&path),
            Action::Set { path, value } => self.set(path, value),
            Action::ResetParams => self.state.overrides.clear(),
            Action::Camera(camera) => {
                if camera.fault().is_none() {
                    self.state.camera = Some(camera);
                }
            }
            Action::Frame => {
                if let (Some(camera), Some([low, high])) = (self.state.camera, self.state.bounds) {
                    self.state.camera = Some(camera::frame(&camera, low, high, self.state.viewport));
                }
            }
            Action::Home => self.state.camera = self.state.home.or(self.state.camera),
            Action::Restart => self.restart(),
            Action::Reload => {
                self.state.busy = Some(Instant::now());
                self.worker.reload();
            }
            Action::Save => self.save_changes(),
            Action::SaveCamera => self.save_camera(),
            Action::Edit { path, line, column } => {
                if let Err(why) = editor::open(&path, line, column) {
                    self.state.say(why);
                }
            }
            Action::Point { at, is_pressed } => self.point(at, is_pressed),
            Action::Keep(slot) => {
                let Some(camera) = self.state.camera else { return };
                self.state.viewpoints.insert(slot, camera);
                let kept = self.state.job.as_ref().map(|job| viewpoints::save(&job.source, &self.state.viewpoints));
                match kept {
                    Some(Err(why)) => self.state.say(format!("the viewpoint is kept until you close: {why}")),
                    _ => self.state.say(format!("viewpoint {slot} was kept")),
                }
            }
            Action::GoTo(slot) => {
                if let Some(camera) = self.state.viewpoints.get(&slot) {
                    self.state.camera = Some(*camera);
                }
            }
            Action::RunAll(on) => {
                self.state.runs_all = on;
                self.version += 1;
            }
            Action::Count(on) => {
                self.state.counts = on;
                self.state.statistics.clear();
            }
            Action::Look(look) => self.state.look = look,
            Action::Hunt => self.state.hunt = Some(Hunt::default()),
            Action::Shoot(path) => self.shot = Some(path),
            Action::Record(recording) => self.record(recording),
            Action::StopRecording => self.state.recording = None,
            Action::Play(on) => self.state.clock.play(on),
            Action::Repeat(on) => self.state.clock.repeats = on,
            Action::Step(frames) => self.state.clock.step(frames),
            Action::Seek(time_s) => self.state.clock.seek(time_s),
            Action::Speed(speed) => self.state.clock.speed = speed,
            Action::Switch { pass, on } => {
                if on {
                    self.state.switched_off.remove(&pass);
                } else {
                    self.state.switched_off.insert(pass);
                }
            }
        }
    }

    pub(super) fn set(&mut self, path: String, value: Option<Value>) {
        let shown = self.state.groups.iter().flat_map(|g| &g.params).find(|p| p.path == path);
        let declared = shown.and_then(|p| p.param.default.clone());
        let said = self.state.in_scene.get(&path).cloned().or(declared);
        match value.filter(|value| said.as_ref() != Some(value)) {
            Some(value) => _ = self.state.overrides.insert(path, value),
            None => _ = self.state.overrides.remove(&path),
        }
    }

    /// A pointer of the graph is where a person points, from now on.
    pub(super) fn point(&mut self, at: [f64; 2], is_pressed: bool) {
        let Some(camera) = self.state.camera else { return };
        let direction = camera::ray(&camera, at, self.state.viewport);
        self.session.point(Pointing { time_s: self.state.clock.time_s, origin: camera.eye, direction, is_pressed });
    }

    pub(super) fn restart(&mut self) {
        self.session.forget_pointing();
        self.state.clock.seek(0.0);
        self.version += 1;
        self.stepped_s = None;
        if let Err(error) = self.session.reset() {
            self.fail(Diagnostics::from(error));
        }
    }
}
