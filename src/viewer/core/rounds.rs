//! What the worker made of the files: content, a plan that is built, and what was wrong.

use std::mem;
use std::time::{Duration, Instant};

use super::Core;
use crate::diagnostic::Severity;
use crate::engine::any_device_gone;
use crate::host::{Built, Content, Input};
use crate::viewer::clock::Beat;
use crate::viewer::params::{self, groups};
use crate::viewer::state::{Findings, Reload, bounds, listed, short};
use crate::viewer::worker::{Cause, Round};

impl Core {
    pub(super) fn take(&mut self, round: Round) {
        let Round { cause, planned, read, mut diagnostics, sources, when, noticing, checking, building, is_last } =
            round;
        if is_last {
            self.state.busy = None;
        }
        let shown = mem::replace(&mut self.answered, when);
        if planned.is_none() && diagnostics.is_empty() {
            return;
        }
        if let Some(read) = &read {
            self.take_content(read);
        }
        let began = Instant::now();
        let mut built = None;
        if let Some(planned) = planned {
            let clock = &self.state.clock;
            let is_back = clock.frame_of(when) < clock.frame_of(shown);
            if self.is_led && cause == Cause::Wanted {
                // Steps that lie before the new files' time see those that were there until then.
                let done = match is_back {
                    true => self.session.reset().map_err(Into::into),
                    false if shown == when => Ok(()),
                    false => self.session.end_steps(shown, when, self.only().as_deref()),
                };
                done.unwrap_or_else(|found| diagnostics.extend(found));
            }
            match self.session.install(*planned) {
                Ok(made) => {
                    self.installed(&made);
                    diagnostics.extend(made.diagnostics.clone());
                    self.sources.clone_from(&sources);
                    built = Some(made);
                }
                Err(found) => {
                    self.is_lost |= any_device_gone(&found);
                    diagnostics.extend(found);
                }
            }
        }
        let (errors, warnings) = (diagnostics.count(Severity::Error), diagnostics.count(Severity::Warning));
        if cause != Cause::Wanted {
            self.state.log(Reload {
                at: Instant::now(),
                what: match &cause {
                    Cause::Opened(path) => format!("opened {}", short(path)),
                    Cause::Changed(files) if files.is_empty() => "reloaded".into(),
                    Cause::Changed(files) => listed(files),
                    Cause::Wanted => String::new(),
                },
                is_good: built.is_some(),
                errors,
                warnings,
                noticing_ms: ms(noticing),
                checking_ms: ms(checking),
                building_ms: ms(building) + ms(began.elapsed()),
                drawing_ms: None,
                pipelines_built: built.as_ref().map_or(0, |b| b.pipelines_built),
                pipelines_kept: built.as_ref().map_or(0, |b| b.pipelines_reused),
                resets: built
                    .as_ref()
                    .map(|b| b.resets.iter().map(|d| d.message.clone()).collect())
                    .unwrap_or_default(),
                pipelines_late: built.as_ref().map_or(0, |b| b.pipelines_late),
            });
            self.reload_pending = built.is_some();
        }
        let is_stale = built.is_none();
        if cause != Cause::Wanted {
            self.is_load_bad = is_stale;
        } else if self.is_load_bad && !is_stale {
            // What is shown now is the last good state in another size or with other values: the files are as
            // wrong as before.
            return;
        }
        self.state.findings = (!diagnostics.is_empty()).then_some(Findings { diagnostics, sources, is_stale });
    }

    /// What files say by now.
    pub(super) fn take_content(&mut self, content: &Content) {
        params::settle(&mut self.state.overrides, content);
        let present = content.present_params.iter().map(|(path, v)| (format!("{}{path}", params::PRESENT), v.clone()));
        let own = content.params.iter().map(|(path, v)| (path.clone(), v.clone()));
        self.state.in_scene = own.chain(present).collect();
        let home = self.state.home.replace(content.camera);
        // A camera that was not moved by hand follows the scene's.
        if self.state.camera.is_none() || self.state.camera == home {
            self.state.camera = Some(content.camera);
        }
    }

    pub(super) fn installed(&mut self, built: &Built) {
        self.counted.forget();
        self.version += 1;
        self.state.memory_bytes = built.memory_bytes;
        self.state.changes_over_time = self.session.changes_over_time();
        self.is_led = self.session.timed_steps_see_files();
        self.state.clock.follow(Beat::of(self.session.tracks().first()));
        self.state.bounds = self.session.content().and_then(bounds);
        let mut inputs = self.session.content().into_iter().flat_map(|content| content.inputs.values());
        self.state.takes_pointer = inputs.any(|input| matches!(input, Input::Pointer(_)));
        if let Some(plan) = self.session.plan() {
            self.state.viewport = plan.viewport;
            self.state.groups = groups(plan, self.session.present_plan());
            self.state.times[0].keep(|path| plan.passes.iter().any(|p| p.path == path));
        }
    }
}

fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
