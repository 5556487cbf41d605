//! Statistics of the frames, while somebody looks at them: asked for after a frame, and taken when they have come.

use super::Core;

/// How far the statistics have come.
#[derive(Debug, Default)]
pub(super) struct Counted {
    /// The frame and the build whose statistics were asked for last.
    of: Option<(u64, u64)>,
    is_asked: bool,
}

impl Counted {
    /// Whether any are on their way.
    pub fn is_asked(&self) -> bool {
        self.is_asked
    }

    /// Those on their way went with what was built before.
    pub fn forget(&mut self) {
        *self = Self::default();
    }
}

impl Core {
    /// Asks and takes; waits for nothing. Tells whether other numbers are there.
    pub(super) fn count(&mut self) -> bool {
        let is_wanted = self.state.counts && self.session.plan().is_some_and(|plan| !plan.stats.is_empty());
        if !is_wanted {
            self.counted.forget();
            return false;
        }
        if self.counted.is_asked {
            let Some(values) = self.session.poll_statistics() else { return false };
            self.counted.is_asked = false;
            let is_new = self.state.statistics != values;
            self.state.statistics = values;
            return is_new;
        }
        let of = Some((self.state.frames, self.version));
        if self.in_flight.is_some() || self.made.is_none() || self.counted.of == of {
            return false;
        }
        self.counted.of = of;
        match self.session.ask_statistics() {
            Ok(()) => {
                self.counted.is_asked = true;
                false
            }
            Err(error) => self.fail(error.into()),
        }
    }
}
