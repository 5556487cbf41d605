//! What runs when only one thing changes, and why: frames with skipping, behind those that are
//! measured without.

use glam::DQuat;
use serde_json::{Value, json};

use crate::diagnostic::Diagnostics;
use crate::engine::Report;
use crate::host::{Live, Session};
use crate::plan::model::Plan;
use crate::scene::Camera;

/// Steps that one frame may run.
const MOST_STEPS: u32 = 4;
/// Seconds of a frame.
const FRAME_S: f64 = 1.0 / 60.0;
/// How far the camera goes around what it looks at, in radians.
const TURN: f64 = 0.01;

/// A frame in which nothing changed but one thing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Change {
    pub what: &'static str,
    pub passes: usize,
    pub passes_run: usize,
    pub units: Vec<Unit>,
}

/// Passes that run or are skipped together.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Unit {
    pub passes: Vec<String>,
    pub ran: bool,
    /// Empty for what was skipped: nothing that it depends on has changed.
    pub why: Vec<String>,
}

/// Draws the scene's graph with skipping after so many frames: unchanged, with another camera, and a frame later.
///
/// # Errors
/// If the device refuses something.
pub(super) fn look(session: &mut Session, drawn: u64) -> Result<Vec<Change>, Diagnostics> {
    let Some(camera) = session.content().map(|content| content.camera) else { return Ok(Vec::new()) };
    session.run_all(false);
    let last = drawn.saturating_sub(1);
    let time_s = last as f64 * FRAME_S;
    let still = Live { camera, time_s, delta_s: FRAME_S, frame: last, steps: &[], only: None };
    // What the frames before left open, such as what a step touched, runs now.
    for _ in 0..2 {
        session.submit(&still)?;
    }
    let nothing = session.submit(&still)?;
    let turned = Live { camera: turned(camera), ..still };
    let orbited = session.submit(&turned)?;
    let time_s = drawn as f64 * FRAME_S;
    let due = session.steps_due(time_s, true, MOST_STEPS).steps;
    let later = session.submit(&Live { time_s, frame: drawn, steps: &due, ..turned })?;
    let of = |(what, report): (&'static str, Report)| session.plan().map(|plan| change(plan, what, &report));
    let all = [("nothing", nothing), ("camera", orbited), ("time", later)];
    Ok(all.into_iter().filter_map(of).collect())
}

fn turned(camera: Camera) -> Camera {
    let eye = camera.target + DQuat::from_rotation_y(TURN) * (camera.eye - camera.target);
    Camera { eye, ..camera }
}

fn change(plan: &Plan, what: &'static str, report: &Report) -> Change {
    let unit = |(unit, did): (&crate::plan::model::Unit, &crate::engine::UnitReport)| Unit {
        passes: unit.passes.iter().map(|p| plan.passes[*p].path.clone()).collect(),
        ran: did.ran,
        why: did.why.iter().map(ToString::to_string).collect(),
    };
    Change {
        what,
        passes: report.passes_planned,
        passes_run: report.passes.len(),
        units: plan.units.iter().zip(&report.units).map(unit).collect(),
    }
}

/// A line for each change, and below it one for each unit that ran.
pub(super) fn text(changes: &[Change]) -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    for change in changes {
        let Change { what, passes, passes_run, units } = change;
        _ = writeln!(text, "if {what} changes: {passes_run} of {passes} passes run");
        for Unit { passes, why, .. } in units.iter().filter(|unit| unit.ran) {
            let first = passes.first().map_or("", String::as_str);
            let more = if passes.len() > 1 { format!(" and {} more", passes.len() - 1) } else { String::new() };
            _ = writeln!(text, "  {first}{more}: {}", why.join(", "));
        }
    }
    text
}

pub(super) fn json(changes: &[Change]) -> Value {
    let unit = |unit: &Unit| json!({"passes": unit.passes, "ran": unit.ran, "why": unit.why});
    let change = |c: &Change| {
        json!({
            "what": c.what, "passes": c.passes, "passes_run": c.passes_run,
            "units": c.units.iter().map(unit).collect::<Vec<_>>(),
        })
    };
    changes.iter().map(change).collect()
}
