//! How a draw becomes pixels: topology, targets, blending, depth and stencil.

use super::{Compare, Sp, View};
use crate::diagnostic::Span;
use crate::graph::expr::Expr;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Topology {
    PointList,
    LineList,
    LineStrip,
    TriangleList,
    TriangleStrip,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Face {
    Front,
    Back,
}

#[derive(Clone, Debug)]
pub struct Target {
    pub to: View,
    /// 1 expression for all channels, or 4; absent: the target loads.
    pub clear: Option<Sp<Vec<Expr>>>,
    pub blend: Option<Sp<Blend>>,
    /// Red, green, blue, alpha.
    pub write: [bool; 4],
    pub resolve: Option<View>,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Blend {
    pub color: BlendComponent,
    pub alpha: BlendComponent,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BlendComponent {
    pub source: Factor,
    pub target: Factor,
    pub operation: Operation,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Factor {
    Zero,
    One,
    Src,
    OneMinusSrc,
    SrcAlpha,
    OneMinusSrcAlpha,
    Dst,
    OneMinusDst,
    DstAlpha,
    OneMinusDstAlpha,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    Add,
    Subtract,
    ReverseSubtract,
    Min,
    Max,
}

/// Depth and stencil of a draw. `Nearest`, `Farthest` and `Test` are written out here.
#[derive(Clone, Debug)]
pub struct Depth {
    pub to: View,
    pub compare: Compare,
    pub write: bool,
    pub clear: Option<Expr>,
    /// Constant and slope.
    pub bias: Option<(Expr, Expr)>,
    pub stencil: Option<Stencil>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Stencil {
    pub compare: Compare,
    pub pass: StencilOperation,
    pub fail: StencilOperation,
    pub depth_fail: StencilOperation,
    pub reference: Expr,
    pub read_mask: u32,
    pub write_mask: u32,
    pub clear: Option<Expr>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StencilOperation {
    Keep,
    Zero,
    Replace,
    Invert,
    IncrementClamp,
    DecrementClamp,
    IncrementWrap,
    DecrementWrap,
}
