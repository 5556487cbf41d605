//! Which steps time asks for.

use super::prepare::Runner;

/// Steps that a frame is to run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Due {
    /// Of each `Steps` of the plan.
    pub steps: Vec<u32>,
    /// There were more than may run at once: time has to slow down, or the frame to be repeated.
    pub is_behind: bool,
    /// The time lies before steps that are done: state has to start anew.
    pub needs_reset: bool,
}

impl Runner {
    /// The steps to run until a time, `most` of each `Steps` at a time, for [`super::Frame::steps`]; `is_new` says that a
    /// new frame begins, which those once a frame count.
    pub fn steps_due(&self, time_s: f64, is_new: bool, most: u32) -> Due {
        let mut due = Due::default();
        for (steps, done) in self.plan.steps.iter().zip(&self.done) {
            let Some(rate) = steps.rate else {
                due.steps.push(u32::from(is_new || *done == 0));
                continue;
            };
            let until = (time_s * rate).floor().max(0.0) as u64;
            due.needs_reset |= until < *done;
            let open = until.saturating_sub(*done);
            due.is_behind |= open > u64::from(most);
            due.steps.push(u32::try_from(open).unwrap_or(u32::MAX).min(most));
        }
        due
    }
}
