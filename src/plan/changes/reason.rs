//! Why a unit runs.

use std::fmt;

use crate::plan::model::{Causes, Plan};

/// Something outside the graph that results depend on.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// The content of an input.
    Input(String),
    /// A value that frames give: `time`, `camera.position`.
    Live(String),
    /// A parameter by its instance path.
    Param(String),
    /// The size of the picture.
    Viewport,
}

/// Why a unit runs.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    /// It has not run yet.
    First,
    /// A pass of it is another than the one that ran: its shader, constants, sizes or targets.
    Pass,
    /// Something that it reads or writes has new memory.
    Memory,
    /// State that it reads started anew.
    Reset,
    /// A step ran.
    Step,
    /// A unit that it reads from runs.
    Upstream,
    /// A unit that runs reads what it writes, whose memory served something else since.
    Shared,
    /// It changes an input, and so is nothing that could be kept.
    WritesInput,
    /// It did not run whole before.
    Unfinished,
    /// Under the smallest policy all run if one does.
    Together,
    /// Somebody asked for all.
    Asked,
    /// Something that it depends on has changed.
    Cause(Cause),
}

/// Every reason that is a mark, in the order of its bits.
const MARKS: [Reason; 11] = [
    Reason::First,
    Reason::Pass,
    Reason::Memory,
    Reason::Reset,
    Reason::Step,
    Reason::Upstream,
    Reason::Shared,
    Reason::WritesInput,
    Reason::Unfinished,
    Reason::Together,
    Reason::Asked,
];

/// Reasons that are no causes, as bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Marks(u16);

impl Marks {
    pub fn add(&mut self, reason: &Reason) {
        if let Some(bit) = MARKS.iter().position(|mark| mark == reason) {
            self.0 |= 1 << bit;
        }
    }

    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub fn reasons(self) -> Vec<Reason> {
        MARKS.iter().enumerate().filter(|(bit, _)| self.0 & (1 << bit) != 0).map(|(_, mark)| mark.clone()).collect()
    }
}

impl Cause {
    pub(super) fn is_among(&self, causes: &Causes) -> bool {
        match self {
            Cause::Input(name) => causes.inputs.contains(name),
            Cause::Live(name) => causes.live.contains(name),
            Cause::Param(path) => causes.params.contains(path),
            Cause::Viewport => causes.viewport,
        }
    }
}

/// Every cause that a unit of the plan has, once.
pub(super) fn causes(plan: &Plan) -> Vec<Cause> {
    let mut all = Causes::default();
    for Causes { inputs, live, params, viewport } in plan.units.iter().map(|unit| &unit.causes) {
        for (all, more) in [(&mut all.inputs, inputs), (&mut all.live, live), (&mut all.params, params)] {
            all.extend(more.iter().filter(|name| !all.contains(*name)).cloned().collect::<Vec<_>>());
        }
        all.viewport |= viewport;
    }
    let inputs = all.inputs.into_iter().map(Cause::Input);
    let live = all.live.into_iter().map(Cause::Live);
    let params = all.params.into_iter().map(Cause::Param);
    inputs.chain(live).chain(params).chain(all.viewport.then_some(Cause::Viewport)).collect()
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::Input(name) => write!(f, "input {name}"),
            Cause::Live(name) => f.write_str(name),
            Cause::Param(path) => write!(f, "parameter {path}"),
            Cause::Viewport => f.write_str("viewport"),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Reason::First => "it had not run",
            Reason::Pass => "another shader, constant, size or target",
            Reason::Memory => "new memory",
            Reason::Reset => "state started anew",
            Reason::Step => "a step ran",
            Reason::Upstream => "what it reads was made anew",
            Reason::Shared => "its memory served something else since",
            Reason::WritesInput => "it changes an input",
            Reason::Unfinished => "it did not run whole before",
            Reason::Together => "all run if one does",
            Reason::Asked => "all were asked for",
            Reason::Cause(cause) => return cause.fmt(f),
        })
    }
}
