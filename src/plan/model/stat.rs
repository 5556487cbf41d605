//! Statistics: numbers over what a frame left in buffers.

use super::ObjectRef;
use crate::diagnostic::Span;
use crate::graph::expr::Expr;
use crate::shader::reflect::Scalar;

/// A statistic of the graph or of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Stat {
    /// Instance path.
    pub path: String,
    /// The expression as written.
    pub text: String,
    /// Its names are `#0`, `#1`, ...: the probes by their places.
    pub value: Expr,
    pub probes: Vec<Probe>,
    /// What nothing writes in this plan, so that there is no value.
    pub missing: Option<String>,
    pub span: Span,
}

/// One number of a buffer.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    pub object: ObjectRef,
    pub kind: ProbeKind,
    /// The numbers of an item that it looks at: one, but for [`ProbeKind::Nans`].
    pub leaves: Vec<Leaf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeKind {
    /// How many items a counted buffer has.
    Count,
    Item(u64),
    /// The least over all items that is a number; likewise the others.
    Min,
    Max,
    Mean,
    Sum,
    /// How many are not a number.
    Nans,
}

/// A number inside of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// Bytes from the start of the item.
    pub offset: u32,
    pub scalar: Scalar,
}
